//! Bad scenes and machines: exit code 1, a message that names the thing, and no output.

use crate::support::{Folder, Quad, assert_fails, assert_says, asset, bake, json, run, tool};

const FEW: [&str; 4] = ["--samples", "16", "--resolution", "16"];

#[test]
fn what_is_no_scene_is_named() {
    let folder = Folder::new();
    assert_fails(&folder, "no/such.gltf", &FEW, 1, &["no/such.gltf"]);
    let text = folder.write("text.gltf", "not glTF");
    assert_fails(&folder, &text, &FEW, 1, &["text.gltf"]);
    let empty = folder.write("empty.glb", "");
    assert_fails(&folder, &empty, &FEW, 1, &["empty.glb"]);
    assert_fails(&folder, &folder.text("."), &FEW, 1, &[&folder.text(".")]);
}

#[test]
fn a_truncated_glb_is_rejected_wherever_it_is_cut() {
    let folder = Folder::new();
    let whole = Quad::default().glb();
    for length in [11, 40, whole.len() / 2, whole.len() - 60, whole.len() - 4] {
        let scene = folder.write("cut.glb", &whole[..length]);
        assert_fails(&folder, &scene, &FEW, 1, &["cut.glb"]);
    }
}

#[test]
fn a_missing_buffer_or_image_is_named() {
    let folder = Folder::new();
    let scene = Quad { buffer: "missing.bin".into(), ..Quad::default() }.write(&folder);
    assert_fails(&folder, &scene, &FEW, 1, &["missing.bin"]);
    let scene = Quad { image: Some("missing.png".into()), ..Quad::default() }.write(&folder);
    assert_fails(&folder, &scene, &FEW, 1, &["missing.png"]);
}

#[test]
fn bad_geometry_is_named() {
    let folder = Folder::new();
    let mut quad = Quad::default();
    quad.positions[2][1] = f32::NAN;
    assert_fails(&folder, &quad.write(&folder), &FEW, 1, &["quad", "vertex 2", "finite"]);
    let mut quad = Quad::default();
    quad.indices[4] = 9;
    assert_fails(&folder, &quad.write(&folder), &FEW, 1, &["quad", "index 9", "out of range"]);
    let quad = Quad { uvs: Some([[0.0, 0.0], [0.0, 1.5], [1.0, 1.0], [1.0, 0.0]]), ..Quad::default() };
    assert_fails(&folder, &quad.write(&folder), &FEW, 1, &["quad", "vertex 1", "allowed is [0, 1]"]);
}

#[test]
fn overlapping_charts_are_counted_and_the_bake_goes_on() {
    let folder = Folder::new();
    let scene = Quad { indices: vec![0, 1, 2, 0, 2, 3, 0, 1, 2], ..Quad::default() }.write(&folder);
    let report = folder.text("r.json");
    let found = bake(&folder, &scene, &["--samples", "16", "--resolution", "16", "--report", &report]);
    assert_eq!(found.code, Some(0), "{found:?}");
    let warning = found.stderr.lines().filter(|line| line.contains("covered more than once")).count();
    assert_eq!(warning, 1, "said once: {found:?}");
    let report = json(&folder.path("r.json"));
    let warnings = report["warnings"].as_array().expect("is a list");
    let count = |text: &str| text.split(' ').next().and_then(|word| word.parse::<u32>().ok());
    let overlap = warnings.iter().filter_map(|w| w.as_str()).find(|w| w.contains("covered more than once"));
    // Half of 256, give or take the diagonal.
    let count = overlap.and_then(count).expect("starts with a count");
    assert!((112..=144).contains(&count), "{count}");
    assert!(folder.path("out.exr").exists());
}

#[test]
fn without_a_driver_the_package_is_named() {
    let folder = Folder::new();
    let empty = folder.write("empty.json", "");
    let output = folder.text("out.exr");
    for driver in ["/nonexistent.json", &empty] {
        for arguments in [&["bake", &asset("cornell.gltf"), "-o", &output][..], &["info"]] {
            let mut command = tool(arguments);
            command.env("VK_DRIVER_FILES", driver).env("VK_ICD_FILENAMES", driver).env_remove("VK_ADD_DRIVER_FILES");
            let found: crate::support::Run = command.output().expect("the tool starts").into();
            assert_eq!(found.code, Some(1), "{found:?}");
            assert!(found.stderr.contains("mesa-vulkan-drivers"), "{found:?}");
        }
    }
    assert_eq!(folder.names(), ["empty.json"]);
}

#[test]
fn ray_query_on_a_device_without_it_is_refused() {
    let found = run(["info"]);
    assert_eq!(found.code, Some(0), "{found:?}");
    let mut index = None;
    let mut without = None;
    for line in found.stdout.lines() {
        if let Some(rest) = line.strip_prefix("device ") {
            index = rest.split(':').next();
        } else if line.split_whitespace().eq(["back", "ends", "software"]) {
            without = without.or(index);
        }
    }
    let Some(index) = without else {
        println!("skipped: every device here has ray query");
        return;
    };
    let folder = Folder::new();
    let options = ["--backend", "ray-query", "--device", index];
    assert_fails(&folder, &asset("cornell.gltf"), &options, 1, &["ray query"]);
}

/// The largest map there is, a quarter of it covered: over any device's limit for one buffer, or its memory.
#[test]
fn a_map_that_a_device_cannot_hold_is_refused() {
    let folder = Folder::new();
    let uvs = Some([[0.0, 0.0], [0.0, 0.5], [0.5, 0.5], [0.5, 0.0]]);
    let scene = Quad { uvs, ..Quad::default() }.write(&folder);
    let before = folder.names();
    let found = bake(&folder, &scene, &["--resolution", "16384", "--samples", "1", "--bounces", "0"]);
    if found.code == Some(0) {
        println!("skipped: this device holds a map of 16384 x 16384");
        return;
    }
    assert_eq!(found.code, Some(1), "{found:?}");
    assert!(found.stderr.contains("error: ") && !found.stderr.contains("panicked"), "{found:?}");
    let names_a_size = ["bytes", "MiB", "GiB"].iter().any(|unit| found.stderr.contains(unit));
    assert!(names_a_size, "what was asked for is not said: {found:?}");
    assert_eq!(folder.names(), before);
}

/// An empty light map, or a black one, and a warning that says why.
#[test]
fn what_can_only_be_black_is_baked_at_once() {
    let folder = Folder::new();
    let unmapped = Quad { uvs: None, ..Quad::default() }.write(&folder);
    bakes_black(&folder, &unmapped, "nothing to bake in");
    let shining = std::fs::read_to_string(Quad::default().write(&folder)).expect("was written");
    let dark = folder.write("dark.gltf", shining.replace("[1.0,1.0,1.0]", "[0,0,0]"));
    bakes_black(&folder, &dark, "nothing shines in");
}

fn bakes_black(folder: &Folder, scene: &str, says: &str) {
    let (report, output) = (folder.text("r.json"), folder.text("o.exr"));
    let found = run(["bake", scene, "-o", &output, "--resolution", "32", "--report", &report]);
    assert_eq!(found.code, Some(0), "{found:?}");
    assert_says(&found.stderr, &[says]);
    let report = json(&folder.path("r.json"));
    assert_eq!((&report["rays"], &report["estimated_error"]), (&0.into(), &0.0.into()));
    assert!(folder.path("o.exr").exists());
}
