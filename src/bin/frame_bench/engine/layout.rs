//! What the raster shaders read, byte for byte as `glsl/include/stage.glsl` declares it.

use bytemuck::{Pod, Zeroable};

/// No texture.
pub(super) const NO_PICTURE: u32 = u32::MAX;

/// A triangle's corner.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Vertex {
    pub(super) position: [f32; 3],
    pub(super) material: u32,
    pub(super) normal: [f32; 3],
    pub(super) mapped: u32,
    pub(super) light_map_uv: [f32; 2],
    pub(super) albedo_uv: [f32; 2],
    pub(super) emission_uv: [f32; 2],
    pub(super) _pad: [f32; 2],
}

/// Where an instance is, in the world and in the light map.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Placing {
    /// Rows.
    pub(super) object_to_world: [[f32; 4]; 3],
    pub(super) scale: [f32; 2],
    pub(super) offset: [f32; 2],
}

/// A material.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Surface {
    pub(super) albedo: [f32; 3],
    pub(super) albedo_picture: u32,
    pub(super) emission: [f32; 3],
    pub(super) emission_picture: u32,
}

/// A texture as a material uses it.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Picture {
    pub(super) first_pixel: u32,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) wrap: u32,
}

/// What is the same for the whole frame.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Frame {
    pub(super) world_to_clip: [f32; 16],
    pub(super) world_to_sun: [f32; 16],
    pub(super) eye: [f32; 3],
    pub(super) exposure: f32,
    pub(super) sun_direction: [f32; 3],
    pub(super) shadow_texel: f32,
    pub(super) sun_irradiance: [f32; 3],
    pub(super) _pad: f32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use spirq::ReflectConfig;
    use spirq::ty::{StructType, Type};
    use spirq::var::Variable;
    use std::collections::BTreeMap;
    use std::mem::offset_of;

    /// Offset of each named member, and the size.
    type Members = (Vec<(String, usize)>, usize);

    macro_rules! host {
        ($type:ident { $($member:ident),+ }) => {
            (
                stringify!($type).to_owned(),
                (vec![$((stringify!($member).to_owned(), offset_of!($type, $member))),+], size_of::<$type>()),
            )
        };
    }

    fn host() -> BTreeMap<String, Members> {
        BTreeMap::from([
            host!(Vertex { position, material, normal, mapped, light_map_uv, albedo_uv, emission_uv }),
            host!(Placing { object_to_world, scale, offset }),
            host!(Surface { albedo, albedo_picture, emission, emission_picture }),
            host!(Picture { first_pixel, width, height, wrap }),
            host!(Frame { world_to_clip, world_to_sun, eye, exposure, sun_direction, shadow_texel, sun_irradiance }),
        ])
    }

    fn members(structure: &StructType, size: usize) -> Members {
        let named = structure.members.iter().map(|member| {
            (member.name.clone().expect("names stay in the modules"), member.offset.expect("blocks have offsets"))
        });
        (named.filter(|(name, _)| !name.starts_with("pad")).collect(), size)
    }

    #[test]
    fn the_shaders_have_the_same_structs() {
        let mut found = BTreeMap::new();
        for module in [super::super::SHADOW_VERT, super::super::VIEW_VERT, super::super::VIEW_FRAG] {
            let mut config = ReflectConfig::new();
            config.spv(bytemuck::pod_collect_to_vec::<u8, u32>(module)).ref_all_rscs(true).combine_img_samplers(true);
            for entry in config.reflect().expect("is SPIR-V") {
                for variable in &entry.vars {
                    let Variable::Descriptor { ty: ty @ Type::Struct(block), .. } = variable else { continue };
                    let (structure, size) = match &block.members[0].ty {
                        Type::Array(array) => match &*array.element_ty {
                            Type::Struct(element) => (element, array.stride.expect("has a stride")),
                            _ => continue,
                        },
                        _ => (block, ty.min_nbyte().expect("has a size")),
                    };
                    found.insert(structure.name.clone().expect("has a name"), members(structure, size));
                }
            }
        }
        assert_eq!(found, host());
    }
}
