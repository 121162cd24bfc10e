//! The specialisation constants of all shaders.

use super::spirv;
use crate::bvh::Bvh;
use crate::features::Features;
use ash::vk;
use bytemuck::{Pod, Zeroable};

/// Values of the specialisation constants; their ids are their places here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Constants {
    /// The scene's `Features`.
    pub(crate) features: u32,
    /// Entries of the traversal stack.
    pub(crate) stack_size: u32,
    /// What `trace.comp` asks of a ray; nobody else reads it.
    pub(crate) query: u32,
    /// Whether the hierarchy is read as texels: [`super::DeviceInfo::reads_texels`], set where a pipeline is made.
    pub(crate) texel_buffers: vk::Bool32,
}

/// Entries of the stack beside nodes: where traversal ends, and where it leaves an object.
const STACK_MARKS: u32 = 2;

impl Constants {
    /// For a scene that needs `features`. The stack grows in steps, so that scenes of about the same depth share compiled
    /// pipelines.
    pub(crate) fn new(features: Features, bvh: &Bvh) -> Self {
        let stack_size = (bvh.most_stack_size() + STACK_MARKS).next_multiple_of(8);
        Self { features: features.bits(), stack_size, query: 0, texel_buffers: vk::FALSE }
    }

    /// Without the bits that none of these modules reads.
    pub(super) fn as_read_by<'a>(self, modules: impl IntoIterator<Item = &'a [u32]>) -> Self {
        let mut bits = [0; spirv::CONSTANTS];
        for module in modules {
            bits.iter_mut().zip(spirv::bits_read(module)).for_each(|(all, read)| *all |= read);
        }
        let mut values: [u32; spirv::CONSTANTS] = bytemuck::cast(self);
        values.iter_mut().zip(bits).for_each(|(value, read)| *value &= read);
        bytemuck::cast(values)
    }

    /// As pipelines are made with them.
    pub(super) fn specialization(&self) -> vk::SpecializationInfo<'_> {
        vk::SpecializationInfo::default().map_entries(&ENTRIES).data(bytemuck::bytes_of(self))
    }
}

const ENTRIES: [vk::SpecializationMapEntry; spirv::CONSTANTS] = [
    vk::SpecializationMapEntry { constant_id: 0, offset: 0, size: 4 },
    vk::SpecializationMapEntry { constant_id: 1, offset: 4, size: 4 },
    vk::SpecializationMapEntry { constant_id: 2, offset: 8, size: 4 },
    vk::SpecializationMapEntry { constant_id: 3, offset: 12, size: 4 },
];
