//! Clusters of source texels that rays are aimed by, and what groups of texels have seen of them. Reads the surface map and
//! the pyramid's leaves; writes the clusters and the leaves' sums within each: one work group a cluster. Then reads the
//! clusters and what was seen of them, and writes the weights by which each group chooses: one work group a group.

use super::nothing::Nothing;
use super::{Context, DeviceScene, GROUPS_IN_A_ROW};
use crate::bvh::Bvh;
use crate::clusters::{Clusters as Layout, LEAST_GROUP_SITES, MOST_CLUSTERS, MOST_GROUPS, Site};
use crate::error::Result;
use crate::features::Features;
use crate::gpu::layout::{self, Push, binding};
use crate::gpu::{
    BindingSet, Buffer, BufferDesc, CLUSTERS, Commands, ComputePipeline, Image, ImageDesc, Location, Recorder,
    Resource, WEIGHTS,
};
use ash::vk;
use bytemuck::Zeroable;
use glam::{Vec2, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// Bits of a texel's seat that name its cluster; those above, its group.
const CLUSTER_BITS: u32 = 10;
const _: () = assert!(MOST_CLUSTERS <= 1 << CLUSTER_BITS);
/// Where each texel sits.
pub(super) const SEATS: vk::Format = vk::Format::R32_UINT;

/// Source texels in clusters, on the device; of a scene in which no rays are aimed so, next to nothing.
pub(crate) struct Sources {
    pub(super) clusters: Arc<Buffer>,
    /// `[place]`: texels, cluster by cluster.
    pub(super) texels: Arc<Buffer>,
    /// `[place]`: sum of the leaves of its cluster up to and with this one.
    pub(super) sums: Arc<Buffer>,
    /// `[texel]`: group and cluster.
    pub(super) seats: Arc<Image>,
    /// `[group]`: where it ends, in places.
    group_ends: Arc<Buffer>,
    /// `[group][cluster]`: sums of what a group's texels choose clusters by.
    pub(super) weights: Arc<Buffer>,
    /// `[group][cluster]`: rays aimed, and above them those that found their aim.
    pub(super) sightings: Arc<Buffer>,
    cluster_count: u32,
    group_count: u32,
    /// One in so many texels tells what it sees, so that counts do not overflow.
    tells_every: u32,
}

impl Sources {
    /// Of no texels.
    pub(super) fn none(nothing: &Nothing) -> Self {
        Self {
            clusters: nothing.buffer(),
            texels: nothing.buffer(),
            sums: nothing.buffer(),
            seats: nothing.image(SEATS),
            group_ends: nothing.buffer(),
            weights: nothing.buffer(),
            sightings: nothing.buffer(),
            cluster_count: 0,
            group_count: 0,
            tells_every: 1,
        }
    }

    /// `surfaces`: the g-buffer's. `nothing`: what stands for sightings where none are needed.
    pub(crate) fn new(
        commands: &mut Commands,
        nothing: Option<&Nothing>,
        bvh: &Bvh,
        scene: &DeviceScene,
        size: [u32; 2],
        surfaces: &[[u32; 4]],
    ) -> Result<Self> {
        let (texels, sites) = sites_of(bvh, scene, size, surfaces);
        let layout = Layout::of(&sites);
        let places: Vec<u32> = layout.order.iter().map(|site| texels[*site as usize]).collect();
        Self::upload(commands, nothing, &layout, &places, size)
    }

    /// `places`: texels, cluster by cluster.
    fn upload(
        commands: &mut Commands,
        nothing: Option<&Nothing>,
        layout: &Layout,
        places: &[u32],
        size: [u32; 2],
    ) -> Result<Self> {
        let cluster = |range: &Range<u32>| layout::Cluster {
            first: range.start,
            count: range.end - range.start,
            ..layout::Cluster::zeroed()
        };
        let clusters: Vec<layout::Cluster> = layout.clusters.iter().map(cluster).collect();
        let seats = seats_of(layout, places, size);
        let table = vec![0_u32; layout.clusters.len() * layout.groups.len()];
        let (format, usage) = (SEATS, vk::ImageUsageFlags::STORAGE);
        let desc = ImageDesc { name: "seats", size, format, usage, mip_levels: 1 };
        Ok(Self {
            clusters: upload(commands, "clusters", &clusters)?,
            sums: upload(commands, "sums within clusters", &vec![0.0_f32; places.len()])?,
            texels: upload(commands, "texels of clusters", places)?,
            seats: Arc::new(commands.upload_image(desc, &seats)?),
            group_ends: upload(commands, "groups", &layout.groups.iter().map(|range| range.end).collect::<Vec<_>>())?,
            weights: upload(commands, "weights of clusters", &vec![0.0_f32; table.len()])?,
            sightings: nothing.map_or_else(|| upload(commands, "sightings", &table), |nothing| Ok(nothing.buffer()))?,
            cluster_count: clusters.len() as u32,
            group_count: layout.groups.len() as u32,
            tells_every: layout.group_sites.div_ceil(SITES_THAT_TELL).max(1),
        })
    }
}

impl Sources {
    /// Bytes of so many texels, about, without their seats.
    pub(crate) fn bytes(texels: u64, features: Features) -> u64 {
        // Place and sum of each texel, and tables of groups by clusters. Halving makes groups from half full to full.
        let tables = if features.contains(Features::VISIBILITY) { 2 } else { 1 };
        let clusters = texels.min(MOST_CLUSTERS as u64);
        let sites = LEAST_GROUP_SITES.max((texels as usize).div_ceil(MOST_GROUPS)) as f64;
        let halved = texels as f64 / (sites * std::f64::consts::LN_2);
        let groups = (halved as u64).max(clusters);
        8 * texels + clusters * (size_of::<layout::Cluster>() as u64 + 4 * tables * groups) + 4 * groups
    }
}

/// Texels of a group that tell what they see, about.
const SITES_THAT_TELL: u32 = 128;

fn upload<T: bytemuck::Pod>(commands: &mut Commands, name: &str, data: &[T]) -> Result<Arc<Buffer>> {
    let (size, usage) = (size_of_val(data) as u64, vk::BufferUsageFlags::STORAGE_BUFFER);
    commands.upload(BufferDesc { name, size, usage, location: Location::Device }, data).map(Arc::new)
}

/// Texels that lie on a surface, as x | y << 16, and where that is.
fn sites_of(bvh: &Bvh, scene: &DeviceScene, size: [u32; 2], surfaces: &[[u32; 4]]) -> (Vec<u32>, Vec<Site>) {
    let mut texels = Vec::new();
    let mut sites = Vec::new();
    for (texel, [owner, primitive, b1, b2]) in surfaces.iter().enumerate() {
        let Some(instance) = owner.checked_sub(1) else { continue };
        let (x, y) = (texel as u32 % size[0], texel as u32 / size[0]);
        texels.push(x | y << 16);
        let barycentrics = Vec2::new(f32::from_bits(*b1), f32::from_bits(*b2));
        sites.push(site_of(bvh, scene, instance, *primitive, barycentrics));
    }
    (texels, sites)
}

fn site_of(bvh: &Bvh, scene: &DeviceScene, instance: u32, primitive: u32, barycentrics: Vec2) -> Site {
    let record = &bvh.instances[instance as usize];
    let corner = |corner: &[f32; 4]| {
        let point = Vec3::from_slice(corner).extend(1.0);
        Vec3::from(record.object_to_world.map(|row| glam::Vec4::from(row).dot(point)))
    };
    let [v0, v1, v2] = [0, 1, 2].map(|i| corner(&bvh.triangles[primitive as usize].corners[i]));
    let (e1, e2) = (v1 - v0, v2 - v0);
    let encoded = &scene.host_primitives[primitive as usize];
    let [t0, t1, t2] = encoded.uvs.map(|[u, v]| Vec2::new(u * record.atlas[0], v * record.atlas[1]));
    let area = e1.cross(e2).length() / (t1 - t0).perp_dot(t2 - t0).abs();
    let [r, g, b] = scene.radiators.materials[encoded.material as usize].emission;
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
    let movable = record.flags & crate::bvh::InstanceRecord::MOVABLE != 0;
    Site {
        position: v0 + e1 * barycentrics.x + e2 * barycentrics.y,
        normal: e1.cross(e2).normalize_or_zero(),
        area: finite(area),
        power: finite(area * luminance),
        body: if movable { instance + 1 } else { 0 },
    }
}

/// `[texel]`: its cluster, and its group above.
fn seats_of(layout: &Layout, places: &[u32], [width, height]: [u32; 2]) -> Vec<u32> {
    let mut seats = vec![0; width as usize * height as usize];
    let mut seat = |range: &Range<u32>, bits: u32| {
        for texel in &places[range.start as usize..range.end as usize] {
            seats[(texel >> 16) as usize * width as usize + (texel & 0xffff) as usize] |= bits;
        }
    };
    layout.clusters.iter().enumerate().for_each(|(index, range)| seat(range, index as u32));
    layout.groups.iter().enumerate().for_each(|(index, range)| seat(range, (index as u32) << CLUSTER_BITS));
    seats
}

pub(crate) struct Clusters {
    pipeline: ComputePipeline,
    set: BindingSet,
    weights: ComputePipeline,
    weights_set: BindingSet,
    count: u32,
    groups: u32,
    tells_every: u32,
}

impl Clusters {
    pub(crate) fn new(context: Context<'_>) -> Result<Self> {
        let (maps, sources) = (context.maps, &context.maps.sources);
        let mut resources = context.scene.surface_resources();
        resources.extend([
            (binding::SURFACE, Resource::StorageImage(&maps.surface)),
            (binding::AIMED_LUMINANCE, Resource::StorageImage(&maps.aimed_luminance)),
            (binding::PIECES_MAP, Resource::StorageImage(&maps.pieces)),
            (binding::PIECES, Resource::Storage(&context.scene.pieces)),
            (binding::CLUSTERS, Resource::Storage(&sources.clusters)),
            (binding::CLUSTER_TEXELS, Resource::Storage(&sources.texels)),
            (binding::CLUSTER_SUMS, Resource::Storage(&sources.sums)),
        ]);
        let pipeline = ComputePipeline::new(context.gpu, &CLUSTERS, context.constants, &resources)?;
        let set = pipeline.bind(&resources)?;
        let mut tables = context.scene.surface_resources();
        tables.extend([
            (binding::SURFACE, Resource::StorageImage(&maps.surface)),
            (binding::CLUSTERS, Resource::Storage(&sources.clusters)),
            (binding::CLUSTER_TEXELS, Resource::Storage(&sources.texels)),
            (binding::GROUP_ENDS, Resource::Storage(&sources.group_ends)),
            (binding::SIGHTINGS, Resource::Storage(&sources.sightings)),
            (binding::WEIGHTS, Resource::Storage(&sources.weights)),
        ]);
        let weights = ComputePipeline::new(context.gpu, &WEIGHTS, context.constants, &tables)?;
        let weights_set = weights.bind(&tables)?;
        let (count, groups, tells_every) = (sources.cluster_count, sources.group_count, sources.tells_every);
        Ok(Self { pipeline, set, weights, weights_set, count, groups, tells_every })
    }

    /// Clusters, which [`Clusters::record`] may be cut into.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    /// Groups, which [`Clusters::record_weights`] may be cut into.
    pub(crate) fn groups(&self) -> u32 {
        self.groups
    }

    /// One in so many texels tells what it sees, so that counts do not overflow.
    pub(crate) fn tells_every(&self) -> u32 {
        self.tells_every
    }

    /// Records the sums of these clusters, once the leaves are whole.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push, clusters: Range<u32>) {
        let push = Push { first_level: clusters.start, ..*push };
        let groups = [clusters.end - clusters.start, 1];
        recorder.dispatch(&self.pipeline, &self.set, &push, groups, c"clusters");
    }

    /// Records the weights of all clusters for these groups, once the clusters are whole, and with what has been learned of
    /// visibility since the last time.
    pub(crate) fn record_weights(&self, recorder: &mut Recorder<'_>, push: &Push, groups: Range<u32>) {
        let push = Push { first_texel: groups.start, texel_count: groups.end - groups.start, ..*push };
        // A group has a work group of its own.
        let columns = push.texel_count.clamp(1, GROUPS_IN_A_ROW);
        let rows = push.texel_count.div_ceil(columns).max(1);
        recorder.dispatch(&self.weights, &self.weights_set, &push, [columns, rows], c"weights");
    }
}
