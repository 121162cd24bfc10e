//! `lightoven bench --growth`: what more triangles and more texels cost.

mod host;
mod report;
mod subdivide;

use super::figures::Spread;
use super::{GATHER_RAYS, OnDevice};
use crate::arguments::{Bench, GrowthArgument};
use crate::progress::Bar;
use crate::{device, interrupt};
use host::HostMemory;
use lightoven::baker::{BakeSettings, Baker, GatherBench};
use lightoven::bvh::{Bvh, Node};
use lightoven::headless::Headless;
use lightoven::scene::{Atlas, Resolution, Scene};
use lightoven::{Error, ErrorKind, Query, Result};
pub(super) use report::Report;
use report::{Axis, Growth, Row, Seconds, SetUp};
use std::time::{Duration, Instant};
use subdivide::{subdivided, triangles_of};

/// The first sizes; each next one has four times the triangles, or texels.
pub(crate) const LEAST_TRIANGLES: u32 = 1 << 10;
pub(crate) const LEAST_SIDE: u32 = 1 << 7;
/// A hierarchy that is quickly built is built again, for a median: this often at most, and no longer than this.
const BUILDS: usize = 5;
const BUILDING: Duration = Duration::from_millis(500);

/// `None` when it was interrupted.
///
/// # Errors
/// `InvalidSettings` for sizes that the scene cannot have. A size that does not fit is a row that says so.
pub(super) fn measure(
    arguments: &Bench,
    growth: GrowthArgument,
    scene: &Scene,
    bar: &Bar,
    start: Instant,
) -> Result<Option<Report>> {
    let subdivisions = if growth == GrowthArgument::Texels {
        arguments.how.refuse_size("--growth texels has sizes of its own")?;
        Vec::new()
    } else {
        subdivisions(triangles_of(scene), arguments.most_triangles)?
    };
    let sides = if growth == GrowthArgument::Triangles { Vec::new() } else { sides(arguments.most_texels) };
    let device = device::open(&arguments.device)?;
    let bench = Sizes { arguments, device: &device, scene, bar, host: HostMemory::new() };
    let resolution = arguments.how.resolution();
    let Some(triangles) = bench.rows(subdivisions.iter().map(|n| (*n, resolution)))? else { return Ok(None) };
    let bench = Sizes { host: HostMemory::new(), ..bench };
    let Some(texels) = bench.rows(sides.iter().map(|side| (1, Resolution::Texels(*side))))? else { return Ok(None) };
    device::fail_on_validation(&device)?;
    let growth = |axis, rows: Vec<Row>| (!rows.is_empty()).then(|| Growth::new(axis, rows));
    Ok(Some(Report {
        scene: scene.name().to_owned(),
        device: device.gpu().info().name.clone(),
        driver: device.gpu().info().driver.clone(),
        backend: device.gpu().backend().name(),
        rays: arguments.rays,
        rounds: arguments.rounds,
        triangles: growth(Axis::Triangles, triangles),
        texels: growth(Axis::Texels, texels),
        seconds: Seconds { total: start.elapsed().as_secs_f64() },
    }))
}

/// Into how many parts edges are cut for about [`LEAST_TRIANGLES`], four times as many, and so on: at least 1.
fn subdivisions(triangles: usize, most: u32) -> Result<Vec<u32>> {
    if triangles > most as usize {
        let context = format!("--most-triangles is {most}; allowed is at least the {triangles} that the scene has");
        return Err(Error::new(ErrorKind::InvalidSettings, context));
    }
    let sizes =
        std::iter::successors(Some(LEAST_TRIANGLES), |size| size.checked_mul(4)).take_while(|size| *size <= most);
    let parts = |size: u32| (f64::from(size) / triangles.max(1) as f64).sqrt().round().max(1.0) as u32;
    let mut found: Vec<u32> = sizes.map(parts).collect();
    found.dedup();
    Ok(found)
}

fn sides(most: u32) -> Vec<u32> {
    std::iter::successors(Some(LEAST_SIDE), |side| side.checked_mul(2)).take_while(|side| *side <= most).collect()
}

/// What all sizes have in common.
struct Sizes<'a> {
    arguments: &'a Bench,
    device: &'a Headless,
    scene: &'a Scene,
    bar: &'a Bar,
    host: HostMemory,
}

impl Sizes<'_> {
    /// `None` when it was interrupted.
    fn rows(&self, sizes: impl Iterator<Item = (u32, Resolution)>) -> Result<Option<Vec<Row>>> {
        let mut rows = Vec::new();
        for (subdivision, resolution) in sizes {
            if interrupt::requested() {
                return Ok(None);
            }
            let Some(row) = self.row(subdivision, resolution)? else { return Ok(None) };
            rows.push(row);
        }
        Ok(Some(rows))
    }

    fn row(&self, subdivision: u32, resolution: Resolution) -> Result<Option<Row>> {
        let scene = subdivided(self.scene, subdivision)?;
        let mut row = Row { triangles: triangles_of(&scene), subdivision, ..Row::default() };
        self.bar.say(format!("{} triangles, {resolution:?}", row.triangles));
        match self.fill(&mut row, &scene, resolution) {
            Ok(ending) => Ok(ending.map(|()| row)),
            Err(error) if matches!(error.kind(), ErrorKind::OutOfMemory | ErrorKind::InvalidSettings) => {
                Ok(Some(Row { failed: Some(error.to_string()), ..row }))
            }
            Err(error) => Err(error),
        }
    }

    /// As far as the size fits; `None` when it was interrupted.
    fn fill(&self, row: &mut Row, scene: &Scene, resolution: Resolution) -> Result<Option<()>> {
        let (done, most) = self.host.most_during(|| self.set_up(row, scene, resolution));
        let bvh = done?;
        row.costs.host_bytes = most;
        self.trace(row, scene, &bvh, resolution)
    }

    /// The hierarchy, and then a baker as `bake` makes it.
    fn set_up(&self, row: &mut Row, scene: &Scene, resolution: Resolution) -> Result<Bvh> {
        let (costs, gpu) = (&mut row.costs, self.device.gpu());
        let atlas = Atlas::new(scene, resolution)?;
        row.resolution = Some(atlas.size.to_array());
        let (bvh, seconds) = build(scene, &atlas)?;
        costs.bvh_seconds = Some(seconds);
        costs.node_bytes = Some(size_of_val::<[Node]>(&bvh.nodes) as u64);
        let (held, started) = (gpu.allocated_bytes(), Instant::now());
        let baker = Baker::new(gpu, scene, &BakeSettings { resolution, ..BakeSettings::default() })?;
        let (total, seconds) = (started.elapsed().as_secs_f64(), &baker.statistics().seconds);
        costs.set_up = SetUp {
            gbuffer_seconds: Some(seconds.gbuffer),
            aiming_seconds: Some(seconds.aiming),
            total_seconds: Some(total - seconds.compile),
        };
        costs.device_bytes = Some(gpu.allocated_bytes().saturating_sub(held));
        row.texels = Some(baker.statistics().texels);
        Ok(bvh)
    }

    /// Seconds a ray, in turn, after a round that warms up; `None` when it was interrupted.
    fn trace(&self, row: &mut Row, scene: &Scene, bvh: &Bvh, resolution: Resolution) -> Result<Option<()>> {
        let Bench { rays, rounds, .. } = *self.arguments;
        let mut bench = GatherBench::new(self.device.gpu(), scene, bvh, resolution)?;
        let sent = bench.rays(rays as usize)?;
        let OnDevice { mut tracer, rays: loaded } = OnDevice::new(self.device, scene, bvh, &sent)?;
        let (mut closest, mut occluded, mut gathered) = (Vec::new(), Vec::new(), Vec::new());
        for round in 0..=rounds {
            if interrupt::requested() {
                return Ok(None);
            }
            let count = sent.rays.len() as f64;
            let found = [
                tracer.time(&loaded, Query::Closest)?.as_secs_f64() / count,
                tracer.time(&loaded, Query::Occluded)?.as_secs_f64() / count,
                gather(&mut bench, rays)?,
            ];
            if round > 0 {
                [&mut closest, &mut occluded, &mut gathered]
                    .into_iter()
                    .zip(found)
                    .for_each(|(all, one)| all.push(one));
            }
        }
        let spread = |seconds: Vec<f64>| Spread::of(seconds.iter().map(|seconds| 1e9 * seconds));
        row.costs.closest_ns = spread(closest);
        row.costs.occluded_ns = spread(occluded);
        row.costs.gather_ns = spread(gathered);
        Ok(Some(()))
    }
}

/// A pass of a bake over so many texels that they send about so many rays; seconds a ray.
fn gather(bench: &mut GatherBench, rays: u32) -> Result<f64> {
    let (texels, time) = bench.gather_part(GATHER_RAYS, rays.div_ceil(GATHER_RAYS))?;
    Ok(time.as_secs_f64() / (f64::from(texels.max(1)) * f64::from(GATHER_RAYS)))
}

/// The hierarchy, and the median of the seconds that building it took.
fn build(scene: &Scene, atlas: &Atlas) -> Result<(Bvh, f64)> {
    let begun = Instant::now();
    let mut seconds = Vec::new();
    loop {
        let started = Instant::now();
        let bvh = Bvh::build(scene, atlas)?;
        seconds.push(started.elapsed().as_secs_f64());
        if seconds.len() == BUILDS || begun.elapsed() >= BUILDING {
            let median = Spread::of(seconds).map_or(0.0, |spread| spread.median);
            return Ok((bvh, median));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_about_four_times_as_large_each() {
        assert_eq!(sides(128), [128]);
        assert_eq!(sides(4096), [128, 256, 512, 1024, 2048, 4096]);
        assert_eq!(sides(5000), sides(4096));
        // A scene of 41,000 triangles is itself the first.
        assert_eq!(subdivisions(41_000, 1 << 22).expect("fits"), [1, 3, 5, 10]);
        assert_eq!(subdivisions(36, 1 << 14).expect("fits"), [5, 11, 21]);
        assert_eq!(subdivisions(5000, 5000).expect("fits"), [1]);
        let error = subdivisions(5000, 4096).expect_err("too many");
        assert!(error.to_string().contains("4096") && error.to_string().contains("5000"), "{error}");
    }
}
