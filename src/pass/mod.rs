//! The passes, one file each, of the same name as its shader.

mod aim;
mod bake;
mod bounce;
mod clusters;
mod dilate;
mod direct;
mod emit;
mod gbuffer;
mod importance;
mod maps;
mod nothing;
mod pieces;
mod primitives;
mod publish;
mod resolve;
mod scene;
mod settle;
mod sheets;
mod source;
mod textures;
mod trace;

pub(crate) use aim::Aim;
pub(crate) use bake::Bake;
pub(crate) use bounce::{Bounce, Links};
pub(crate) use clusters::Sources;
pub(crate) use dilate::Dilate;
pub(crate) use direct::Direct;
pub(crate) use emit::{Emit, Groups};
pub(crate) use gbuffer::Gbuffer;
pub(crate) use maps::{Maps, activity};
pub(crate) use nothing::Nothing;
pub(crate) use pieces::Pieces;
pub(crate) use publish::Publish;
pub(crate) use resolve::{Resolve, ResolveSums};
pub(crate) use scene::{DeviceScene, encode_light};
pub(crate) use settle::Settle;
pub(crate) use source::{Source, SourceSums};
pub use trace::Query;
pub(crate) use trace::Trace;

use crate::error::Result;
use crate::gpu::layout::{GROUP, Push};
use crate::gpu::{Buffer, BufferDesc, Commands, Constants, Gpu, Location};
use ash::vk;
use clusters::Clusters;
use importance::Importance;
use std::ops::Range;

/// What every pass is made from.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) constants: Constants,
    pub(crate) scene: &'a DeviceScene,
    pub(crate) maps: &'a Maps,
}

/// What a texel of the light map is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TexelKind {
    /// No surface lies there.
    Empty,
    /// A surface inside something: it takes no rays.
    GivenUp,
    /// It takes rays.
    Baked,
}

/// The texels that lie on a surface.
pub(crate) struct TexelList {
    /// Those that are baked, then those that are given up.
    pub(crate) buffer: Buffer,
    /// How many are baked.
    pub(crate) count: u32,
    /// How many are given up: they emit all the same.
    pub(crate) given_up: u32,
    /// `[group]`: how many texels each of its two fields has.
    pub(crate) fields: Vec<[u32; 2]>,
    /// One `vec4` a work group, for the host to read.
    pub(crate) sums: Buffer,
}

/// Side of the blocks that the list goes through the map in: neighbours then share a work group.
const BLOCK: usize = 8;

impl TexelList {
    /// `kind_of` is asked of every texel, row-major.
    pub(crate) fn new(
        gpu: &Gpu,
        commands: &mut Commands,
        size: [u32; 2],
        kind_of: impl Fn(usize) -> TexelKind,
    ) -> Result<Self> {
        let mut texels = list(size, |texel| kind_of(texel) == TexelKind::Baked);
        let count = texels.len() as u32;
        let fields = texels.chunks(GROUP as usize).map(count_fields).collect();
        texels.extend(list(size, |texel| kind_of(texel) == TexelKind::GivenUp));
        let given_up = texels.len() as u32 - count;
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let size = size_of_val(texels.as_slice()) as u64;
        let desc = BufferDesc { name: "texels", size, usage: storage, location: Location::Device };
        let size = u64::from(count.max(given_up).div_ceil(GROUP)) * 16;
        let sums = Buffer::new(gpu, BufferDesc { name: "sums", size, usage: storage, location: Location::ReadBack })?;
        Ok(Self { buffer: commands.upload(desc, &texels)?, count, given_up, fields, sums })
    }

    /// Whether the same number of texels lie in the same work groups.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        (self.count, self.given_up, &self.fields) == (other.count, other.given_up, &other.fields)
    }

    /// The texels that are given up, as a range of the list.
    pub(crate) fn rest(&self) -> Range<u32> {
        self.count..self.count + self.given_up
    }

    /// What the work groups of a pass over the whole list summed up, in f64, in order.
    pub(crate) fn read_sums(&self) -> Vec<[f64; 4]> {
        let groups = self.count.div_ceil(GROUP) as usize;
        let sums: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&self.sums.bytes()[..groups * 16]);
        sums.into_iter().map(|sum| sum.map(f64::from)).collect()
    }
}

/// Texels of each field of a work group, as `glsl/include/texels.glsl` has them: rows of eight take turns.
fn count_fields(texels: &[u32]) -> [u32; 2] {
    let mut count = [0; 2];
    texels.chunks(8).enumerate().for_each(|(row, texels)| count[row % 2] += texels.len() as u32);
    count
}

fn list([width, height]: [u32; 2], wanted: impl Fn(usize) -> bool) -> Vec<u32> {
    let (width, height) = (width as usize, height as usize);
    let mut texels = Vec::new();
    for y0 in (0..height).step_by(BLOCK) {
        for x0 in (0..width).step_by(BLOCK) {
            for y in y0..(y0 + BLOCK).min(height) {
                let row = (x0..(x0 + BLOCK).min(width)).filter(|x| wanted(y * width + x));
                texels.extend(row.map(|x| x as u32 | (y as u32) << 16));
            }
        }
    }
    texels
}

/// Work groups of a pass over texels of the list; one at least, which has nothing to do where there are none.
fn groups_of(push: &Push) -> [u32; 2] {
    let groups = push.texel_count.div_ceil(GROUP).max(1);
    let width = groups.min(GROUPS_IN_A_ROW);
    [width, groups.div_ceil(width)]
}

/// Every device takes 65,535 work groups along an axis: a map of 2048 x 2048 texels has more in one row.
const GROUPS_IN_A_ROW: u32 = 32_768;
