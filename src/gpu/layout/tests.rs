//! Reflects every compiled module and compares it with what the host writes, in both directions.

use super::{Answer, Cluster, Light, Link, Material, Piece, Primitive, Push, TracedRay, binding};
use crate::bvh::{InstanceRecord, Node, Triangle};
use crate::gpu::Constants;
use spirq::ReflectConfig;
use spirq::ty::{DescriptorType, StructType, Type};
use spirq::var::Variable;
use std::collections::{BTreeMap, BTreeSet};
use std::mem::offset_of;
use std::path::Path;

/// Name and offset of each member.
type Members = Vec<(&'static str, usize)>;

/// A struct that both sides write: its name in GLSL, its size, and its members here but for padding, which offsets and
/// size tell.
struct HostStruct {
    name: &'static str,
    size: usize,
    members: Members,
}

macro_rules! host_struct {
    ($glsl:literal, $type:ty { $($member:ident),+ $(,)? }) => {
        HostStruct {
            name: $glsl,
            size: size_of::<$type>(),
            members: vec![$((stringify!($member), offset_of!($type, $member))),+],
        }
    };
}

fn host_structs() -> Vec<HostStruct> {
    vec![
        // Its codes are the fourth components of lo0 and hi0.
        host_struct!("Node", Node { lo0, hi0, lo1, hi1 }),
        host_struct!("Triangle", Triangle { corners }),
        host_struct!("Primitive", Primitive { uvs, normals, material, flags, sheet }),
        host_struct!("Material", Material { albedo, emission }),
        host_struct!("Cluster", Cluster { centre, spread, axis, even, power, first, count }),
        host_struct!("Link", Link { texel, weight }),
        host_struct!("Piece", Piece { instance, primitive, lo, hi }),
        host_struct!(
            "Instance",
            InstanceRecord { object_to_world, world_to_object, root, first_primitive, flags, atlas }
        ),
        host_struct!("Light", Light { position, kind, direction, range, intensity, cone_scale, cone_offset }),
        host_struct!("Ray", TracedRay { origin, t_min, direction, t_max, skip_instance, skip_primitive }),
        host_struct!("Answer", Answer { t, instance, primitive, front_face, barycentrics }),
        host_struct!(
            "Push",
            Push {
                map_size,
                first_texel,
                texel_count,
                first_quantum,
                quantum_count,
                light_count,
                root,
                sky,
                origin_offset,
                seed,
                instance,
                step_texels,
                mean_luminance,
                rays,
                source_rays,
                sky_rays,
                evidence_quantum,
                first_level,
                end_level,
                first_sample,
                history,
                link_stride
            }
        ),
    ]
}

/// What a binding is: a storage buffer of which elements, or another kind.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Storage(String),
    StorageImage(String),
    Sampled,
    Texels,
    Texture,
    Structure,
}

fn storage(element: &str) -> Kind {
    Kind::Storage(element.into())
}

fn image(format: &str) -> Kind {
    Kind::StorageImage(format.into())
}

/// Every binding, and what may stand there: the passes' descriptor sets and the images' formats in `pass/maps.rs`.
fn host_bindings() -> BTreeMap<u32, BTreeSet<Kind>> {
    let radiance = || image("Rgba32f");
    let bindings = [
        (binding::HIERARCHY, vec![storage("Node"), Kind::Structure]),
        (binding::TRIANGLES, vec![storage("Triangle")]),
        (binding::PRIMITIVES, vec![storage("Primitive")]),
        (binding::INSTANCES, vec![storage("Instance")]),
        (binding::MATERIALS, vec![storage("Material")]),
        (binding::TEXELS, vec![storage("u32")]),
        (binding::LIGHTS, vec![storage("Light")]),
        (binding::SKY_MAP, vec![Kind::Texture]),
        (binding::SURFACE, vec![image("Rgba32ui")]),
        (binding::FOOTPRINT, vec![image("R32ui")]),
        (binding::SOURCE_MAP, vec![Kind::Sampled]),
        (binding::MEAN_EVEN, vec![radiance()]),
        (binding::MEAN_ODD, vec![radiance()]),
        (binding::TEXTURE, vec![Kind::Texture]),
        (binding::TEXCOORDS, vec![storage("vec2<f32>")]),
        (binding::TRIANGLE_TEXELS, vec![Kind::Texels]),
        (binding::DIRECT, vec![radiance()]),
        (binding::ALBEDO, vec![image("Rgba32f")]),
        (binding::EMISSION, vec![radiance()]),
        (binding::SOURCE_IMAGE, vec![radiance()]),
        (binding::SUMS, vec![storage("vec4<f32>")]),
        (binding::LIGHT_MAP, vec![radiance()]),
        (binding::NEAREST_BEFORE, vec![image("R32ui")]),
        (binding::NEAREST_AFTER, vec![image("R32ui")]),
        (binding::RAYS, vec![storage("Ray")]),
        (binding::ANSWERS, vec![storage("Answer")]),
        (binding::IMPORTANCE, vec![Kind::Sampled]),
        (binding::SKY_IMPORTANCE, vec![Kind::Sampled]),
        (binding::PYRAMID, vec![radiance()]),
        (binding::EVIDENCE, vec![radiance()]),
        (binding::SKY_EVIDENCE, vec![radiance()]),
        (binding::PIECES_MAP, vec![image("R32ui")]),
        (binding::PIECES, vec![storage("Piece")]),
        (binding::AIMED_LUMINANCE, vec![image("R32f")]),
        (binding::CLUSTERS, vec![storage("Cluster")]),
        (binding::CLUSTER_TEXELS, vec![storage("u32")]),
        (binding::CLUSTER_SUMS, vec![storage("f32")]),
        (binding::SEATS, vec![image("R32ui")]),
        (binding::WEIGHTS, vec![storage("f32")]),
        (binding::SIGHTINGS, vec![storage("u32")]),
        (binding::GROUP_ENDS, vec![storage("u32")]),
        (binding::LINKS, vec![storage("Link")]),
        (binding::ACTIVITY, vec![storage("u32")]),
        (binding::NODE_TEXELS, vec![Kind::Texels]),
    ];
    bindings.into_iter().map(|(binding, kinds)| (binding, kinds.into_iter().collect())).collect()
}

/// spirq evaluates what is calculated from specialisation constants, and knows but a few operations; no layout depends on
/// them, and each becomes a plain zero.
fn settle_calculated_constants(words: &[u32]) -> Vec<u32> {
    const HEADER: usize = 5;
    const CONSTANT_NULL: u32 = 3 << 16 | 46;
    const SPEC_CONSTANT_OP: u32 = 52;
    let (header, mut rest) = words.split_at(HEADER);
    let mut settled = header.to_vec();
    while !rest.is_empty() {
        let (instruction, following) = rest.split_at((rest[0] >> 16) as usize);
        if instruction[0] & 0xffff == SPEC_CONSTANT_OP {
            settled.extend([CONSTANT_NULL, instruction[1], instruction[2]]);
        } else {
            settled.extend(instruction);
        }
        rest = following;
    }
    settled
}

/// The benchmark's own modules have other structs, which `src/bin/frame_bench/engine/layout.rs` compares.
const BENCHMARK: [&str; 3] = ["shadow.vert.spv", "view.frag.spv", "view.vert.spv"];

/// Every variable of every module of the library, with the module's name.
fn variables() -> Vec<(String, Variable)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("glsl/spirv");
    let mut variables = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the modules are there") {
        let path = entry.expect("can be listed").path();
        if path.extension().is_none_or(|extension| extension != "spv") {
            continue;
        }
        let name = path.file_name().expect("is a file").to_string_lossy().into_owned();
        if BENCHMARK.contains(&name.as_str()) {
            continue;
        }
        let bytes = std::fs::read(&path).expect("can be read");
        let words = settle_calculated_constants(&bytemuck::pod_collect_to_vec(&bytes));
        let mut config = ReflectConfig::new();
        config.spv(words).ref_all_rscs(true).combine_img_samplers(true);
        let entries = config.reflect().unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(entries.len(), 1, "{name}");
        variables.extend(entries[0].vars.iter().map(|variable| (name.clone(), variable.clone())));
    }
    variables
}

/// The element of a block that is one array without a length.
fn element(block: &Type) -> &Type {
    let Type::Struct(StructType { members, .. }) = block else { panic!("{block:?} is no block") };
    let [member] = members.as_slice() else { panic!("{block:?} has more than an array") };
    assert_eq!(member.offset, Some(0));
    let Type::Array(array) = &member.ty else { panic!("{block:?} is no array") };
    assert_eq!(array.nelement, None);
    if let Some(structure) = host_structs().iter().find(|host| name_of(&array.element_ty) == host.name) {
        assert_eq!(array.stride, Some(structure.size), "stride of {}", structure.name);
    }
    &array.element_ty
}

fn name_of(ty: &Type) -> String {
    match ty {
        Type::Struct(structure) => structure.name.clone().unwrap_or_default(),
        other => other.to_string(),
    }
}

fn kind_of(descriptor: &DescriptorType, ty: &Type) -> Kind {
    match (descriptor, ty) {
        (DescriptorType::StorageBuffer(_), block) => storage(&name_of(element(block))),
        (DescriptorType::StorageImage(_), Type::StorageImage(ty)) => image(&format!("{:?}", ty.fmt)),
        (DescriptorType::UniformTexelBuffer(), _) => Kind::Texels,
        (DescriptorType::SampledImage(), _) => Kind::Sampled,
        (DescriptorType::CombinedImageSampler(), _) => Kind::Texture,
        (DescriptorType::AccelStruct(), _) => Kind::Structure,
        other => panic!("no pass can bind {other:?}"),
    }
}

/// Structs by name with their members, as the modules have them; `Push` for the push constants.
fn device_structs() -> BTreeMap<String, BTreeSet<Vec<(String, usize)>>> {
    let mut structs: BTreeMap<String, BTreeSet<Vec<(String, usize)>>> = BTreeMap::new();
    for (module, variable) in variables() {
        let structure = match &variable {
            Variable::PushConstant { ty, .. } => ty,
            Variable::Descriptor { desc_ty: DescriptorType::StorageBuffer(_), ty, .. } => element(ty),
            _ => continue,
        };
        let Type::Struct(structure) = structure else { continue };
        let member = |(index, member): (usize, &spirq::ty::StructMember)| {
            let name = member.name.clone().unwrap_or_else(|| panic!("{module}: member {index} lost its name"));
            (name, member.offset.expect("blocks have offsets"))
        };
        let members = structure.members.iter().enumerate().map(member);
        let members = members.filter(|(name, _)| !name.starts_with("pad")).collect();
        structs.entry(structure.name.clone().unwrap_or_default()).or_default().insert(members);
    }
    structs
}

#[test]
fn structs_have_the_same_members_at_the_same_offsets() {
    let device = device_structs();
    let host = host_structs();
    let names: BTreeSet<&str> = device.keys().map(String::as_str).collect();
    assert_eq!(names, host.iter().map(|host| host.name).collect(), "structs of the modules, and of the host");
    for host in host {
        let expected: Vec<_> = host.members.into_iter().map(|(name, offset)| (name.to_owned(), offset)).collect();
        for members in &device[host.name] {
            assert_eq!(*members, expected, "struct {}", host.name);
        }
    }
}

#[test]
fn structs_have_the_same_size() {
    // Strides say it of elements; nothing is smaller than what the last member takes.
    for (module, variable) in variables() {
        if let Variable::PushConstant { ty, .. } = &variable {
            assert_eq!(ty.min_nbyte(), Some(size_of::<Push>()), "{module}: push constants");
        }
        if let Variable::Descriptor { desc_ty: DescriptorType::StorageBuffer(_), ty, .. } = &variable {
            element(ty);
        }
    }
}

#[test]
fn bindings_are_of_the_same_kind() {
    let mut device: BTreeMap<u32, BTreeSet<Kind>> = BTreeMap::new();
    let host = host_bindings();
    for (module, variable) in variables() {
        let Variable::Descriptor { desc_bind, desc_ty, ty, nbind, .. } = &variable else { continue };
        let (set, binding) = (desc_bind.set(), desc_bind.bind());
        assert_eq!((set, *nbind), (0, 1), "{module}: {variable:?}");
        let kind = kind_of(desc_ty, ty);
        let expected = host.get(&binding).unwrap_or_else(|| panic!("{module}: the host has no binding {binding}"));
        assert!(expected.contains(&kind), "{module}, binding {binding}: {kind:?}, here {expected:?}");
        device.entry(binding).or_default().insert(kind);
    }
    assert_eq!(device, host, "what the modules bind, and what the host does");
}

#[test]
fn specialisation_ids_are_the_constants_places() {
    let expected = BTreeSet::from([
        ("FEATURES".to_owned(), offset_of!(Constants, features) as u32 / 4),
        ("STACK_SIZE".to_owned(), offset_of!(Constants, stack_size) as u32 / 4),
        ("QUERY".to_owned(), offset_of!(Constants, query) as u32 / 4),
        ("TEXEL_BUFFERS".to_owned(), offset_of!(Constants, texel_buffers) as u32 / 4),
    ]);
    let mut found = BTreeSet::new();
    for (module, variable) in variables() {
        let Variable::SpecConstant { name, spec_id, .. } = &variable else { continue };
        let constant = (name.clone().unwrap_or_default(), *spec_id);
        assert!(expected.contains(&constant), "{module}: {constant:?}");
        found.insert(constant);
    }
    assert_eq!(found, expected);
    assert_eq!(size_of::<Constants>(), 4 * expected.len());
}
