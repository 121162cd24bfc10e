use super::*;
use glam::{DMat3, Vec2};

/// A unit square in the plane z = 0 that fills the light map.
fn quad() -> MeshPart {
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    MeshPart {
        positions: corners.map(|c| c.extend(0.0)).to_vec(),
        light_map_uvs: Some(corners.to_vec()),
        indices: vec![0, 1, 2, 0, 2, 3],
        ..MeshPart::default()
    }
}

fn scene_of(parts: Vec<MeshPart>, transforms: &[DAffine3]) -> Result<Scene> {
    let instance = |(i, t): (usize, &DAffine3)| Instance {
        name: format!("i{i}"),
        mesh: 0,
        transform: *t,
        mobility: Mobility::Static,
    };
    Scene::new(SceneDesc {
        name: "test".into(),
        meshes: vec![MeshDesc { name: "quad".into(), parts }],
        instances: transforms.iter().enumerate().map(instance).collect(),
        materials: vec![Material::default()],
        ..SceneDesc::default()
    })
}

fn message(result: Result<Scene>) -> String {
    result.expect_err("must be rejected").to_string()
}

#[test]
fn bad_meshes_are_rejected_by_name() {
    let bad = |change: fn(&mut MeshPart)| {
        let mut part = quad();
        change(&mut part);
        message(scene_of(vec![part], &[DAffine3::IDENTITY]))
    };
    assert!(bad(|p| p.positions[2].x = f32::NAN).contains("the position of vertex 2"));
    assert!(bad(|p| p.indices[1] = 4).contains("index 4 is out of range; there are 4 vertices"));
    assert!(bad(|p| p.indices.truncate(4)).contains("multiple of 3"));
    assert!(bad(|p| p.material = 1).contains("refers to material 1"));
    assert!(bad(|p| p.normals = Some(vec![Vec3::Z])).contains("has 1 normals for 4 vertices"));
    assert!(bad(|p| p.light_map_uvs.as_mut().expect("has")[0].x = 1.5).contains("allowed is [0, 1]"));
}

#[test]
fn degenerate_triangles_are_dropped_and_counted() {
    let mut part = quad();
    part.indices.extend([0, 0, 1]);
    let scene = scene_of(vec![part], &[DAffine3::IDENTITY]).expect("is valid");
    assert_eq!(scene.meshes()[0].len(), 2);
    assert!(scene.warnings()[0].contains("1 triangles without area"));
}

#[test]
fn singular_instances_are_left_out() {
    let flat = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)));
    let scene = scene_of(vec![quad()], &[flat, DAffine3::IDENTITY]).expect("is valid");
    assert_eq!(scene.instances().len(), 1);
    assert!(scene.warnings()[0].contains("singular"));
    let thin = DAffine3::from_scale(DVec3::new(1.0, 1000.0, 1e-6));
    assert_eq!(scene_of(vec![quad()], &[thin]).expect("is valid").instances().len(), 1);
}

#[test]
fn albedo_is_clamped_and_negatives_are_rejected() {
    let material = |albedo, emission| {
        let material = Material { name: "m".into(), albedo, emission, ..Material::default() };
        Scene::new(SceneDesc { materials: vec![material], ..SceneDesc::default() })
    };
    let scene = material(Vec3::new(1.5, f32::NAN, 0.5), Vec3::ZERO).expect("is valid");
    assert_eq!(scene.materials()[0].albedo, Vec3::new(MAX_ALBEDO, MAX_ALBEDO, 0.5));
    assert_eq!(scene.warnings().len(), 1);
    assert!(message(material(Vec3::splat(-0.1), Vec3::ZERO)).contains("albedo of material 'm'"));
    for beside in [f32::NAN, f32::INFINITY, 0.5] {
        let refused = message(material(Vec3::new(beside, -0.1, 0.5), Vec3::ZERO));
        assert!(refused.contains("albedo of material 'm' is") && refused.contains("at least 0"), "{refused}");
    }
    assert!(message(material(Vec3::ZERO, Vec3::splat(f32::INFINITY))).contains("emission of material 'm'"));
}

/// Of a texture's factor too, but for what a file says that says nothing.
#[test]
fn a_textures_factor_is_clamped_with_a_warning() {
    for (factor, warnings) in [(0.5, 0), (1.0, 0), (1.001, 1), (f32::INFINITY, 1), (f32::NAN, 1)] {
        let albedo_texture = Some(TextureUse { texture: 0, wrap: [Wrap::Repeat; 2] });
        let albedo = Vec3::new(0.25, factor, 1.0);
        let materials = vec![Material { name: "m".into(), albedo, albedo_texture, ..Material::default() }];
        let textures = vec![Texture { name: "t".into(), width: 1, height: 1, pixels: vec![[255; 4]] }];
        let scene = Scene::new(SceneDesc { materials, textures, ..SceneDesc::default() }).expect("is valid");
        assert_eq!(scene.materials()[0].albedo, Vec3::new(0.25, factor.min(MAX_ALBEDO), MAX_ALBEDO));
        assert_eq!(scene.warnings().len(), warnings, "{factor}: {:?}", scene.warnings());
        assert!(scene.warnings().iter().all(|warning| warning.contains("albedo of material 'm'")));
    }
}

/// However long they are, directions are directions.
#[test]
fn directions_of_any_length_but_0_are_taken() {
    let light = |direction| {
        let light = Light { name: "sun".into(), intensity: Vec3::ONE, kind: LightKind::Directional { direction } };
        Scene::new(SceneDesc { lights: vec![light], ..SceneDesc::default() })
    };
    let tiny = f32::from_bits(1);
    for length in [tiny, 1e-30, 1e-22, 1.0, 1e19, 1e30, f32::MAX / 2.0] {
        let scene = light(Vec3::new(0.0, -2.0, 0.0) * length).expect("is valid");
        assert_eq!(scene.lights()[0].kind, LightKind::Directional { direction: Vec3::NEG_Y }, "{length}");
        let mut part = quad();
        part.normals = Some(vec![Vec3::X * length; 4]);
        let scene = scene_of(vec![part], &[DAffine3::IDENTITY]).expect("is valid");
        assert!(scene.meshes()[0].normals().iter().flatten().all(|normal| *normal == Vec3::X), "{length}");
    }
    for none in [Vec3::ZERO, Vec3::new(0.0, f32::INFINITY, 1.0), Vec3::new(f32::NAN, 0.0, 1.0)] {
        assert!(message(light(none)).contains("the direction of light 'sun'"), "{none}");
    }
}

#[test]
fn one_instance_keeps_its_atlas_and_two_are_packed() {
    let one = scene_of(vec![quad()], &[DAffine3::IDENTITY]).expect("is valid");
    let atlas = Atlas::new(&one, Resolution::Texels(64)).expect("fits");
    assert!(atlas.shared);
    assert_eq!(atlas.overlapping_texels, 0);
    let wide = DAffine3::from_scale(DVec3::splat(2.0));
    let two = scene_of(vec![quad()], &[DAffine3::IDENTITY, wide]).expect("is valid");
    let atlas = Atlas::new(&two, Resolution::Texels(64)).expect("fits");
    assert!(!atlas.shared);
    assert_eq!(atlas.overlapping_texels, 0);
    let ratio = atlas.rects[1].scale.x / atlas.rects[0].scale.x;
    assert!((ratio - 2.0).abs() < 0.01, "texel density differs between instances: {ratio}");
    let dense = Atlas::new(&two, Resolution::PerUnit(10.0)).expect("fits");
    assert_eq!(dense.rects[0].scale, Vec2::splat(10.0));
}

#[test]
fn overlaps_within_an_instance_are_counted() {
    let scene = scene_of(vec![quad(), quad()], &[DAffine3::IDENTITY]).expect("is valid");
    let atlas = Atlas::new(&scene, Resolution::Texels(16)).expect("fits");
    assert_eq!((atlas.covered_texels, atlas.overlapping_texels), (256, 256));
}

#[test]
fn resolutions_outside_the_range_are_rejected() {
    let scene = scene_of(vec![quad()], &[DAffine3::IDENTITY]).expect("is valid");
    for side in [0, 100_000] {
        let error = Atlas::new(&scene, Resolution::Texels(side)).expect_err("must be rejected").to_string();
        assert!(error.contains(&side.to_string()) && error.contains("1 to 16384"), "{error}");
    }
    assert!(Atlas::new(&scene, Resolution::PerUnit(f32::NAN)).is_err());
}

#[test]
fn a_bad_sky_is_rejected_and_the_old_one_stays() {
    let mut scene = scene_of(vec![quad()], &[DAffine3::IDENTITY]).expect("is valid");
    scene.set_sky(Sky::Constant(Vec3::ONE)).expect("is valid");
    let error = scene.set_sky(Sky::Constant(Vec3::NEG_ONE)).expect_err("must be rejected").to_string();
    assert!(error.contains("the sky's radiance"), "{error}");
    assert_eq!(*scene.sky(), Sky::Constant(Vec3::ONE));
}

#[test]
fn nothing_shines_through_a_black_texture() {
    let texture = |value| Texture { name: "t".into(), width: 2, height: 1, pixels: vec![[0, 0, 0, 255], value] };
    let shines = |value| {
        let emission_texture = Some(TextureUse { texture: 0, wrap: [Wrap::Repeat; 2] });
        let material = Material { emission: Vec3::ONE, emission_texture, ..Material::default() };
        let desc = SceneDesc { materials: vec![material], textures: vec![texture(value)], ..SceneDesc::default() };
        Scene::new(desc).expect("is valid").materials()[0].is_emissive()
    };
    assert!(!shines([0, 0, 0, 255]) && shines([0, 0, 1, 0]));
}
