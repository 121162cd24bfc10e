//! What gathering light consists of, to be measured: its rays, and its pass.

use super::{BakeSettings, Bounces, Core, Sampling, Statistics};
use crate::bvh::{Bvh, Ray};
use crate::error::{Error, Result};
use crate::features::Features;
use crate::gpu::layout::{GROUP, Push, TracedRay};
use crate::gpu::{Buffer, BufferDesc, Gpu, Location, Stopwatch};
use crate::pass::{Bake, Emit, Groups};
use crate::scene::{Atlas, Resolution, Scene};
use ash::vk;
use std::ops::Range;
use std::time::Duration;

/// A scene whose light is about to be gathered, by the cosine alone.
pub struct GatherBench {
    core: Core,
    bake: Bake,
    stopwatch: Stopwatch,
}

/// Rays as a bake sends them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SentRays {
    /// `[ray]`, in the order of the bake's work: of 64 texels first the rays of one stratum, then of the next.
    pub rays: Vec<Ray>,
    /// `[ray]`: the (instance, primitive) that it starts from and does not hit.
    pub skip: Vec<Option<(u32, u32)>>,
}

/// Rays a texel, each of a stratum of its own, as in a static bake.
const RAYS: u32 = 64;
/// Rays of a work group.
const GROUP_RAYS: usize = (GROUP * RAYS) as usize;
/// Work groups whose rays are written at once: 48 MiB.
const GROUPS_AT_ONCE: u32 = 256;
/// Texels of one dispatch: all of a map of 512 x 512, and a second of 32 rays each on a slow device.
const TEXELS_AT_ONCE: usize = 1 << 18;
/// Stretches that a part of the light map is gathered in: each is a dispatch that should fill the device.
const STRETCHES: u32 = 16;

impl GatherBench {
    /// Draws the g-buffer; `bvh` is the scene's hierarchy. Waits for the device.
    ///
    /// # Errors
    /// As [`super::Baker::new`].
    pub fn new(gpu: &Gpu, scene: &Scene, bvh: &Bvh, resolution: Resolution) -> Result<Self> {
        let (sampling, bounces) = (Sampling::Cosine, Bounces::Limit(0));
        // Rays are sent, whether there is light for them or not.
        let unneeded = Features::GATHERING;
        let settings = BakeSettings { resolution, sampling, bounces, unneeded, ..BakeSettings::default() };
        let atlas = Atlas::new(scene, resolution)?;
        let (features, mut bvh) = (Features::required(scene, &settings), bvh.clone());
        let core = Core::new(gpu, scene, &settings, &mut bvh, atlas, features, Statistics::default(), None)?;
        let bake = Bake::new(core.context(), &core.texels)?;
        Ok(Self { bake, stopwatch: Stopwatch::new(gpu)?, core })
    }

    /// Width and height of the light map, texels.
    pub fn size(&self) -> [u32; 2] {
        self.core.maps.size
    }

    /// Texels that take rays.
    pub fn texels(&self) -> u32 {
        self.core.texels.count
    }

    /// `count` rays, from all over the light map.
    ///
    /// # Errors
    /// `InvalidScene` where no texel takes rays; `OutOfMemory`, `DeviceLost` or `Driver` from the device.
    pub fn rays(&mut self, count: usize) -> Result<SentRays> {
        let core = &mut self.core;
        let (usage, location) = (vk::BufferUsageFlags::STORAGE_BUFFER, Location::ReadBack);
        let size = GROUPS_AT_ONCE as u64 * (GROUP_RAYS * size_of::<TracedRay>()) as u64;
        let buffer = Buffer::new(&core.gpu, BufferDesc { name: "rays", size, usage, location })?;
        let emit = Emit::new(core.context(), &core.texels, &buffer)?;
        let wanted = u32::try_from(count.div_ceil(GROUP_RAYS)).unwrap_or(u32::MAX);
        let groups = core.texels.count.div_ceil(GROUP);
        let step = groups.div_ceil(wanted.max(1)).max(1);
        let mut sent = SentRays::default();
        let mut push = Push { rays: RAYS, ..core.push };
        while sent.rays.len() < count {
            let before = sent.rays.len();
            // The last selected group may be the list's last.
            for first in (0..groups.div_ceil(step)).step_by(GROUPS_AT_ONCE as usize) {
                let count = (groups.div_ceil(step) - first).min(GROUPS_AT_ONCE);
                let selected = Groups { first: first * step, step, count };
                core.commands.run(|recorder| {
                    emit.record(recorder, &push, &core.texels, selected);
                    Ok(())
                })?;
                let size = count as usize * GROUP_RAYS * size_of::<TracedRay>();
                sent.extend(&bytemuck::pod_collect_to_vec(&buffer.bytes()[..size]));
            }
            if sent.rays.len() == before {
                return Err(Error::scene("no texel of the light map takes rays"));
            }
            push.first_sample += RAYS;
        }
        sent.rays.truncate(count);
        sent.skip.truncate(count);
        Ok(sent)
    }

    /// Gathers once with so many rays a texel, as every pass of a bake does, and returns how long the device took for
    /// that: by its timestamps, or the host's clock where it has none. A driver that compiles at the first use does so in the
    /// first call.
    ///
    /// # Errors
    /// `DeviceLost` or `Driver` from the device.
    pub fn gather(&mut self, rays: u32) -> Result<Duration> {
        Ok(self.gather_part(rays, self.texels())?.1)
    }

    /// The same of about so many texels, in a few stretches from all over the light map: a large map gives as many rays as
    /// a small one. Returns how many texels those were.
    ///
    /// # Errors
    /// As [`GatherBench::gather`].
    pub fn gather_part(&mut self, rays: u32, texels: u32) -> Result<(u32, Duration)> {
        let Self { core, bake, stopwatch } = self;
        let push = Push { rays, ..core.push };
        let (mut gathered, mut sum) = (0, Duration::ZERO);
        for texels in stretches(core.texels.count, texels) {
            gathered += texels.end - texels.start;
            sum += stopwatch.run(&mut core.commands, |recorder| bake.record(recorder, &push, 0, texels, 0..1))?;
        }
        Ok((gathered, sum))
    }
}

/// Parts of a list of `count` texels, about `wanted` in all, whole work groups but for the last.
fn stretches(count: u32, wanted: u32) -> Vec<Range<u32>> {
    if wanted >= count {
        let end = |first: u32| count.min(first + TEXELS_AT_ONCE as u32);
        return (0..count).step_by(TEXELS_AT_ONCE).map(|first| first..end(first)).collect();
    }
    let length = wanted.div_ceil(STRETCHES).next_multiple_of(GROUP).min(TEXELS_AT_ONCE as u32);
    let first = |stretch: u32| (u64::from(count) * u64::from(stretch) / u64::from(STRETCHES)) as u32 / GROUP * GROUP;
    let ends = (1..STRETCHES).map(first).chain([count]);
    let stretches = (0..STRETCHES).map(first).zip(ends).map(|(first, end)| first..end.min(first + length));
    stretches.filter(|stretch| !stretch.is_empty()).collect()
}

impl SentRays {
    /// Leaves out those that go nowhere.
    fn extend(&mut self, rays: &[TracedRay]) {
        for (ray, skip) in rays.iter().map(TracedRay::decode).filter(|(ray, _)| ray.t_max > 0.0) {
            self.rays.push(ray);
            self.skip.push(skip);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_spread_over_the_list() {
        assert_eq!(stretches(300_000, 300_000), [0..1 << 18, 1 << 18..300_000]);
        assert!(stretches(0, 5).is_empty());
        for (count, wanted) in [(1 << 24, 1 << 16), (1000, 999), (100, 1), (65_537, 65_536), (1 << 28, 1 << 27)] {
            let parts = stretches(count, wanted);
            assert!(parts.iter().all(|part| !part.is_empty() && part.start % GROUP == 0 && part.end <= count));
            assert!(parts.windows(2).all(|pair| pair[0].end <= pair[1].start), "{parts:?}");
            let sum: u32 = parts.iter().map(|part| part.end - part.start).sum();
            assert!(sum <= wanted.next_multiple_of(GROUP * STRETCHES), "{sum} of {wanted}");
        }
        let spread = stretches(1 << 24, 1 << 16);
        assert_eq!((spread.len(), spread[15].clone()), (16, 15 << 20..(15 << 20) + 4096));
    }
}
