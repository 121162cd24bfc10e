//! Traces rays of the caller's choice on the device: for comparing back ends with each other and with the host.

use crate::bvh::{Bvh, Hit, Ray};
use crate::error::{Error, Result};
use crate::features::Features;
use crate::gpu::layout::{Answer, Push, TracedRay};
use crate::gpu::{BindingSet, Buffer, BufferDesc, Commands, Constants, Gpu, Location, Stopwatch};
use crate::pass::{DeviceScene, Nothing, Query, Trace};
use crate::scene::Scene;
use ash::vk;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// A scene on the device, ready to be traced.
pub struct Tracer {
    gpu: Gpu,
    commands: Commands,
    stopwatch: Stopwatch,
    trace: Trace,
    scene: DeviceScene,
    push: Push,
    id: u64,
}

/// Rays on the device, with room for their answers: 80 bytes each. Only the tracer that loaded them takes them.
pub struct LoadedRays {
    tracer: u64,
    batches: Vec<Batch>,
}

/// Tracers that have been made.
static TRACERS: AtomicU64 = AtomicU64::new(0);

/// Rays of one dispatch.
struct Batch {
    // Dropped before what it binds.
    set: BindingSet,
    _rays: Buffer,
    answers: Buffer,
    count: u32,
}

/// Rays of one dispatch: 48 MiB, where 128 is the least limit of a buffer.
const BATCH: usize = 1 << 20;

impl Tracer {
    /// Uploads the scene. `bvh` is its hierarchy, in whose coordinates the rays are.
    ///
    /// # Errors
    /// `OutOfMemory`, saying what was asked for; `DeviceLost` or `Driver` from the device.
    pub fn new(gpu: &Gpu, scene: &Scene, bvh: &Bvh) -> Result<Self> {
        let mut commands = Commands::new(gpu)?;
        let stopwatch = Stopwatch::new(gpu)?;
        let features = Features::of(scene);
        let nothing = Nothing::new(&mut commands)?;
        let scene = DeviceScene::new(gpu, &mut commands, scene, bvh, features, &nothing)?;
        let trace = Trace::new(gpu, Constants::new(features, bvh), &scene)?;
        let push = Push { root: bvh.root(), ..Push::default() };
        let id = TRACERS.fetch_add(1, Ordering::Relaxed);
        Ok(Self { gpu: gpu.clone(), commands, stopwatch, trace, scene, push, id })
    }

    /// Closest hits, `[ray]`. `skip` is `[ray]` too: the (instance, primitive) that a ray starts from and does not hit.
    ///
    /// A query for any hit is made for each ray as well; where it does not agree with the closest one, the primitive is
    /// `u32::MAX`.
    ///
    /// # Errors
    /// `OutOfMemory`, `DeviceLost` or `Driver` from the device.
    pub fn trace(&mut self, rays: &[Ray], skip: &[Option<(u32, u32)>]) -> Result<Vec<Option<Hit>>> {
        let mut hits = Vec::with_capacity(rays.len());
        for (rays, skip) in rays.chunks(BATCH).zip(skip.chunks(BATCH)) {
            let loaded = self.load(rays, skip)?;
            self.time(&loaded, Query::Occluded)?;
            let occluded = self.answers(&loaded)?;
            self.time(&loaded, Query::Closest)?;
            let closest = self.answers(&loaded)?.into_iter().zip(occluded);
            hits.extend(closest.zip(rays).map(|((hit, any), ray)| agreed(hit, any, ray)));
        }
        Ok(hits)
    }

    /// Brings rays to the device, to be traced any number of times; `skip` as in [`Tracer::trace`].
    ///
    /// # Errors
    /// `OutOfMemory`, `DeviceLost` or `Driver` from the device.
    pub fn load(&mut self, rays: &[Ray], skip: &[Option<(u32, u32)>]) -> Result<LoadedRays> {
        let chunks = rays.chunks(BATCH).zip(skip.chunks(BATCH));
        let batches = chunks.map(|(rays, skip)| self.load_batch(rays, skip)).collect::<Result<_>>()?;
        Ok(LoadedRays { tracer: self.id, batches })
    }

    /// Descriptors hold what the tracer that made them owns.
    fn check(&self, rays: &LoadedRays) -> Result<()> {
        let (mine, theirs) = (self.id, rays.tracer);
        if mine == theirs {
            return Ok(());
        }
        Err(Error::settings(format!("the rays are those of tracer {theirs}; allowed are those of this one, {mine}")))
    }

    fn load_batch(&mut self, rays: &[Ray], skip: &[Option<(u32, u32)>]) -> Result<Batch> {
        let encoded: Vec<TracedRay> = rays.iter().zip(skip).map(|(ray, skip)| TracedRay::new(ray, *skip)).collect();
        let (usage, location) = (vk::BufferUsageFlags::STORAGE_BUFFER, Location::Device);
        let size = size_of_val(encoded.as_slice()) as u64;
        let rays = self.commands.upload(BufferDesc { name: "rays", size, usage, location }, &encoded)?;
        let size = (encoded.len() * size_of::<Answer>()) as u64;
        let usage = usage | vk::BufferUsageFlags::TRANSFER_SRC;
        let answers = Buffer::new(&self.gpu, BufferDesc { name: "answers", size, usage, location })?;
        let set = self.trace.bind(&self.scene, &rays, &answers)?;
        Ok(Batch { set, _rays: rays, answers, count: encoded.len() as u32 })
    }

    /// Traces, and returns how long the device took for that alone: by its timestamps, or the host's clock where it has
    /// none. A driver that compiles at the first use does so in the first call for each query.
    ///
    /// # Errors
    /// `InvalidSettings` for rays of another tracer; `DeviceLost` or `Driver` from the device.
    pub fn time(&mut self, rays: &LoadedRays, query: Query) -> Result<Duration> {
        self.check(rays)?;
        let mut sum = Duration::ZERO;
        for batch in &rays.batches {
            let (trace, push) = (&self.trace, &self.push);
            sum += self.stopwatch.run(&mut self.commands, |recorder| {
                trace.record(recorder, query, &batch.set, push, batch.count);
            })?;
        }
        Ok(sum)
    }

    /// What the last [`Tracer::time`] found, `[ray]`. Of a query for any hit only whether there is one means something.
    ///
    /// # Errors
    /// `InvalidSettings` for rays of another tracer; `OutOfMemory`, `DeviceLost` or `Driver` from the device.
    pub fn answers(&mut self, rays: &LoadedRays) -> Result<Vec<Option<Hit>>> {
        self.check(rays)?;
        let mut hits = Vec::new();
        for batch in &rays.batches {
            let size = u64::from(batch.count) * size_of::<Answer>() as u64;
            let (usage, location) = (vk::BufferUsageFlags::TRANSFER_DST, Location::ReadBack);
            let answers = Buffer::new(&self.gpu, BufferDesc { name: "answers", size, usage, location })?;
            self.commands.run(|recorder| {
                recorder.copy_buffer(&batch.answers, &answers, size);
                Ok(())
            })?;
            let answers: Vec<Answer> = bytemuck::pod_collect_to_vec(&answers.bytes()[..size as usize]);
            hits.extend(answers.iter().map(Answer::hit));
        }
        Ok(hits)
    }
}

/// The closest hit, its primitive `u32::MAX` where the query for any hit says otherwise.
fn agreed(closest: Option<Hit>, any: Option<Hit>, ray: &Ray) -> Option<Hit> {
    let miss = Hit { t: ray.t_max, instance: 0, primitive: 0, u: 0.0, v: 0.0, front_face: false };
    match (closest, any) {
        (None, None) | (Some(_), Some(_)) => closest,
        _ => Some(Hit { primitive: u32::MAX, ..closest.unwrap_or(miss) }),
    }
}

impl Answer {
    fn hit(&self) -> Option<Hit> {
        let Self { t, instance, primitive, front_face, barycentrics: [u, v], .. } = *self;
        (instance != u32::MAX).then_some(Hit { t, instance, primitive, u, v, front_face: front_face != 0 })
    }
}
