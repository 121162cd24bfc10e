//! Traces rays of the caller's choice on the device: for comparing back ends with each other and with the host.

use crate::bvh::{Bvh, Hit, Ray};
use crate::error::Result;
use crate::features::Features;
use crate::gpu::layout::{Answer, Push, TracedRay};
use crate::gpu::{Buffer, BufferDesc, Commands, Constants, Gpu, Location};
use crate::pass::{DeviceScene, Trace};
use crate::scene::Scene;
use ash::vk;

/// A scene on the device, ready to be traced.
///
/// Dropping it waits for the device.
pub struct Tracer {
    // Dropped first: waits for what is under way.
    commands: Commands,
    trace: Trace,
    rays: Buffer,
    answers: Buffer,
    _scene: DeviceScene,
    push: Push,
}

/// Rays of one dispatch.
const BATCH: usize = 1 << 16;

impl Tracer {
    /// Uploads the scene. `bvh` is its hierarchy, in whose coordinates the rays are.
    ///
    /// # Errors
    /// `OutOfMemory`, saying what was asked for; `DeviceLost` or `Driver` from the device.
    pub fn new(gpu: &Gpu, scene: &Scene, bvh: &Bvh) -> Result<Self> {
        let mut commands = Commands::new(gpu)?;
        let device_scene = DeviceScene::new(gpu, &mut commands, scene, bvh, Features::required(scene))?;
        let buffer = |name, size: usize, location| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            Buffer::new(gpu, BufferDesc { name, size: (size * BATCH) as u64, usage, location })
        };
        let rays = buffer("rays", size_of::<TracedRay>(), Location::Upload)?;
        let answers = buffer("answers", size_of::<Answer>(), Location::ReadBack)?;
        let constants = Constants::new(Features::required(scene), bvh);
        let trace = Trace::new(gpu, constants, &device_scene, &rays, &answers)?;
        let push = Push { root: bvh.root(), ..Push::default() };
        Ok(Self { commands, trace, rays, answers, _scene: device_scene, push })
    }

    /// Closest hits, `[ray]`. `skip` is `[ray]` too: the (instance, primitive) that a ray starts from and does not hit.
    ///
    /// A query for any hit is made for each ray as well; where it does not agree with the closest one, the primitive is
    /// `u32::MAX`.
    ///
    /// # Errors
    /// `DeviceLost` or `Driver` from the device.
    pub fn trace(&mut self, rays: &[Ray], skip: &[Option<(u32, u32)>]) -> Result<Vec<Option<Hit>>> {
        let mut hits = Vec::with_capacity(rays.len());
        for (rays, skip) in rays.chunks(BATCH).zip(skip.chunks(BATCH)) {
            let encoded: Vec<TracedRay> = rays.iter().zip(skip).map(|(ray, skip)| encode(ray, *skip)).collect();
            self.rays.write(&encoded);
            let (trace, push) = (&self.trace, &self.push);
            self.commands.run(|recorder| {
                trace.record(recorder, push, encoded.len() as u32);
                Ok(())
            })?;
            let size = encoded.len() * size_of::<Answer>();
            let answers: Vec<Answer> = bytemuck::pod_collect_to_vec(&self.answers.bytes()[..size]);
            hits.extend(answers.iter().map(decode));
        }
        Ok(hits)
    }
}

fn encode(ray: &Ray, skip: Option<(u32, u32)>) -> TracedRay {
    let (skip_instance, skip_primitive) = skip.unwrap_or((u32::MAX, u32::MAX));
    TracedRay {
        origin: ray.origin.into(),
        t_min: ray.t_min,
        direction: ray.direction.into(),
        t_max: ray.t_max,
        skip_instance,
        skip_primitive,
        pad: [0; 2],
    }
}

fn decode(answer: &Answer) -> Option<Hit> {
    let Answer { t, instance, primitive, front_face, barycentrics: [u, v], .. } = *answer;
    (instance != u32::MAX || primitive == u32::MAX).then_some(Hit {
        t,
        instance,
        primitive,
        u,
        v,
        front_face: front_face != 0,
    })
}
