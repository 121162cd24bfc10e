//! Hierarchy, instances and lights.

use crate::{assert_invalid, scene, square};
use glam::{DVec3, Vec3};
use lightoven::scene::{LightKind, Mobility};
use serde_json::{Value, json};

#[test]
fn transforms_are_composed_and_meshes_shared() {
    let mut builder = square();
    // A quarter turn about y takes +x to -z.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    builder.root["nodes"] = json!([
        { "name": "root", "translation": [10, 0, 0], "rotation": [0, half, 0, half], "children": [1, 2] },
        { "name": "first", "mesh": 0, "scale": [2, 3, -4] },
        { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1] },
    ]);
    let scene = scene(&builder);
    assert_eq!(scene.meshes().len(), 1);
    let [first, second] = scene.instances() else { panic!("two instances, not {:?}", scene.instances()) };
    assert_eq!((first.name.as_str(), second.name.as_str()), ("first", "node 2"));
    let at = |p: DVec3, q: DVec3| assert!((p - q).length() < 1e-6, "{p} is not {q}");
    at(first.transform.transform_point3(DVec3::ONE), DVec3::new(10.0 - 4.0, 3.0, -2.0));
    at(second.transform.transform_point3(DVec3::ZERO), DVec3::new(10.0 + 7.0, 6.0, -5.0));
    assert!(first.transform.matrix3.determinant() < 0.0);
}

#[test]
fn the_default_scene_is_read_else_the_first_else_all_roots() {
    let mut builder = square();
    builder.root["nodes"] = json!([{ "mesh": 0, "name": "a" }, { "mesh": 0, "name": "b" }, { "children": [1] }]);
    builder.root["scenes"] = json!([{ "nodes": [0] }, { "nodes": [2] }]);
    let names = |root: &Value| {
        let mut builder = square();
        builder.root = root.clone();
        scene(&builder).instances().iter().map(|i| i.name.clone()).collect::<Vec<_>>()
    };
    assert_eq!(names(&builder.root), ["a"]);
    builder.root["scene"] = json!(1);
    assert_eq!(names(&builder.root), ["b"]);
    let root = builder.root.as_object_mut().expect("is an object");
    root.remove("scene");
    root.remove("scenes");
    assert_eq!(names(&builder.root), ["a", "b"]);
}

#[test]
fn a_hundred_thousand_levels_do_not_overflow_the_stack() {
    let mut builder = square();
    let depth = 100_000;
    let mut nodes: Vec<Value> =
        (0..depth).map(|i| json!({ "children": [i + 1], "translation": [0.5, 0, 0] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    builder.root["nodes"] = json!(nodes);
    let scene = scene(&builder);
    assert_eq!(scene.instances()[0].transform.translation.x, 0.5 * f64::from(depth));
}

#[test]
fn cycles_and_shared_children_are_refused() {
    let mut builder = square();
    builder.root["nodes"] = json!([{ "mesh": 0, "children": [1] }, { "name": "loop", "children": [0] }]);
    assert_invalid(&builder, &["node 0", "reached twice", "tree"]);
    builder.root["nodes"] = json!([{ "children": [0] }]);
    assert_invalid(&builder, &["node 0", "reached twice"]);
    // Without the check, 2 to the 60th instances.
    let doubling = (0..60).map(|i| json!({ "children": [i + 1, i + 1] })).chain([json!({ "mesh": 0 })]);
    builder.root["nodes"] = doubling.collect();
    assert_invalid(&builder, &["node 60", "reached twice"]);
}

#[test]
fn transforms_that_are_none_are_refused() {
    let mut builder = square();
    builder.root["nodes"] = json!([{ "mesh": 0, "name": "bent", "matrix": vec![1; 16] }]);
    assert_invalid(&builder, &["'bent'", "last row"]);
    builder.root["nodes"] = json!([{ "mesh": 0, "name": "far", "translation": [1e39, 0, 0] }]);
    assert_invalid(&builder, &["'far'", "not finite"]);
    builder.root["nodes"] = json!([{ "mesh": 0, "name": "spun", "rotation": [0, 0, 0, 0] }]);
    assert_invalid(&builder, &["'spun'", "not finite"]);
}

#[test]
fn what_an_animation_moves_is_movable() {
    let mut builder = square();
    builder.root["nodes"] = json!([
        { "name": "door", "children": [1] },
        { "name": "handle", "mesh": 0 },
        { "name": "wall", "mesh": 0 },
        { "name": "face", "mesh": 0 },
    ]);
    builder.root["scenes"] = json!([{ "nodes": [0, 2, 3] }]);
    let channel = |node: u32, path: &str| json!({ "sampler": 0, "target": { "node": node, "path": path } });
    let channels = [
        channel(0, "rotation"),
        channel(3, "weights"),
        channel(99, "translation"),
        json!({ "sampler": 0, "target": { "path": "pointer" } }),
    ];
    builder.root["animations"] = json!([{ "channels": channels, "samplers": [{ "input": 0, "output": 0 }] }]);
    let scene = scene(&builder);
    let mobilities: Vec<_> = scene.instances().iter().map(|i| (i.name.as_str(), i.mobility)).collect();
    let expected = [("handle", Mobility::Movable), ("wall", Mobility::Static), ("face", Mobility::Static)];
    assert_eq!(mobilities, expected);
}

#[test]
fn lights_stand_and_shine_as_their_nodes_do() {
    let mut builder = square();
    builder.root["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    builder.root["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "intensity": 3, "color": [1, 0.5, 0.25], "name": "sun" },
        { "type": "point", "range": 4 },
        { "type": "spot", "spot": { "innerConeAngle": 0.5, "outerConeAngle": 0.5 } },
    ] } });
    let light = |light: u32| json!({ "KHR_lights_punctual": { "light": light } });
    let half = std::f64::consts::FRAC_1_SQRT_2;
    builder.root["nodes"] = json!([
        { "rotation": [-half, 0, 0, half], "scale": [2, 2, 2], "children": [1, 2, 3] },
        { "extensions": light(0) },
        { "extensions": light(1), "translation": [0, 0, 1], "name": "lamp" },
        { "extensions": light(2) },
    ]);
    let scene = scene(&builder);
    let [sun, lamp, spot] = scene.lights() else { panic!("three lights, not {:?}", scene.lights()) };
    assert_eq!((sun.name.as_str(), sun.intensity), ("sun", Vec3::new(3.0, 1.5, 0.75)));
    let LightKind::Directional { direction } = sun.kind else { panic!("{:?}", sun.kind) };
    assert!((direction - Vec3::NEG_Y).length() < 1e-6, "{direction}");
    let LightKind::Point { position, range } = lamp.kind else { panic!("{:?}", lamp.kind) };
    assert!((position - DVec3::Y * 2.0).length() < 1e-6, "{position}");
    assert_eq!((lamp.name.as_str(), range), ("lamp", Some(4.0)));
    let LightKind::Spot { inner_angle, outer_angle, range, .. } = spot.kind else { panic!("{:?}", spot.kind) };
    assert!(inner_angle < outer_angle && outer_angle == 0.5 && range.is_none());

    builder.root["extensions"]["KHR_lights_punctual"]["lights"][2]["spot"] = json!({ "outerConeAngle": 2.0 });
    assert_invalid(&builder, &["'node 3'", "2 radians", "pi/2"]);
    builder.root["nodes"][3]["extensions"] = light(7);
    assert_invalid(&builder, &["nodes[3]", "light", "out of bounds"]);
}
