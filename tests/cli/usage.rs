//! Bad usage: exit code 2, the value, what is allowed, and no output.

use crate::support::{Folder, Quad, assert_fails, asset, bake, run};

#[test]
fn values_out_of_range_are_named_with_what_is_allowed() {
    let folder = Folder::new();
    let scene = Quad::default().write(&folder);
    let bad = [
        ("--resolution", "0", "1 to 16384"),
        ("--resolution", "100000", "1 to 16384"),
        ("--resolution", "-5", "1 to 16384"),
        ("--texels-per-unit", "nan", "over 0"),
        ("--texels-per-unit", "-1", "over 0"),
        ("--samples", "0", "from 1"),
        ("--samples", "-3", "from 1"),
        ("--error", "NaN", "over 0"),
        ("--error", "0", "over 0"),
        ("--error", "-0.1", "over 0"),
        ("--time", "0s", "over 0"),
        ("--time", "-1s", "over 0"),
        ("--time", "soon", "as in 30s"),
        ("--sky", "-1,0,0", "at least 0"),
        ("--sky", "nan,0,0", "at least 0"),
        ("--sky", "1,1", "three"),
        ("--sky", "blue", ".exr"),
        ("--bounces", "-1", "auto"),
        ("--bounces", "many", "auto"),
        ("--seed", "x", "whole number"),
        ("--backend", "magic", "ray-query"),
    ];
    for (option, value, allowed) in bad {
        assert_fails(&folder, &scene, &[option, value], 2, &[option, &format!("'{value}'"), allowed]);
    }
    assert_fails(&folder, &scene, &["--resolution", "64", "--texels-per-unit", "2"], 2, &["cannot be used with"]);
}

#[test]
fn a_command_and_its_files_are_needed() {
    for arguments in [&[][..], &["bake"], &["bake", "scene.gltf"], &["compare", "a.exr"], &["cook"]] {
        let found = run(arguments);
        assert_eq!(found.code, Some(2), "{found:?}");
        assert!(found.stdout.is_empty() && found.stderr.contains("Usage"), "{found:?}");
    }
}

#[test]
fn help_and_version_are_no_failure() {
    for arguments in [&["--help"][..], &["bake", "--help"], &["--version"], &["help", "compare"]] {
        let found = run(arguments);
        assert_eq!(found.code, Some(0), "{found:?}");
        assert!(found.stdout.contains("ightoven") || found.stdout.contains("compare"), "{found:?}");
    }
}

#[test]
fn an_output_must_not_replace_an_input_or_another_output() {
    let folder = Folder::new();
    let scene = Quad::default().write(&folder);
    let before = std::fs::read(&scene).expect("is there");
    let found = run(["bake", &scene, "-o", &scene]);
    assert_eq!(found.code, Some(2), "{found:?}");
    assert!(found.stderr.contains("same file as the scene"), "{found:?}");
    assert_eq!(std::fs::read(&scene).expect("is there"), before);
    let out = folder.text("./out.exr");
    assert_fails(&folder, &scene, &["--report", &out], 2, &["--report", "same file as --output"]);
}

#[test]
fn an_output_that_cannot_be_written_fails_before_the_bake() {
    let folder = Folder::new();
    let scene = asset("cornell.gltf");
    let file = folder.write("file", "");
    for path in [folder.text("missing/out.exr"), format!("{file}/out.exr"), folder.text(".")] {
        let found = run(["bake", &scene, "-o", &path]);
        assert_eq!(found.code, Some(1), "{found:?}");
        assert!(found.stderr.contains(&format!("cannot write '{path}'")), "{found:?}");
    }
    let report = folder.text("missing/r.json");
    assert_fails(&folder, &scene, &["--report", &report], 1, &[&report, "there is no folder"]);
    let preview = folder.text("missing/p.png");
    assert_fails(&folder, &scene, &["--preview", &preview], 1, &[&preview, "there is no folder"]);
    assert_eq!(folder.names(), ["file"]);
}

#[test]
fn a_sky_that_cannot_be_used_is_named() {
    let folder = Folder::new();
    let scene = asset("cornell.gltf");
    assert_fails(&folder, &scene, &["--sky", "no/such.exr"], 1, &["no/such.exr"]);
    let damaged = folder.write("sky.exr", "not an image");
    assert_fails(&folder, &scene, &["--sky", &damaged], 1, &["sky.exr"]);
    let pixels = vec![[1.0, f32::NAN, 1.0, 1.0]; 2];
    let light_map = lightoven::baker::LightMap { width: 2, height: 1, pixels };
    lightoven::io::exr::write_light_map(&folder.path("sky.exr"), &light_map, &Default::default()).expect("is written");
    assert_fails(&folder, &scene, &["--sky", &damaged], 1, &["sky.exr", "column 0, row 0"]);
}

#[test]
fn an_unknown_device_is_named() {
    let folder = Folder::new();
    let found = bake(&folder, &asset("cornell.gltf"), &["--device", "no such device"]);
    assert!(matches!(found.code, Some(1 | 2)), "{found:?}");
    assert!(found.stderr.contains("no such device"), "{found:?}");
    assert!(folder.names().is_empty());
}
