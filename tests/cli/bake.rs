//! Bakes of the project's own scenes, and what is said about them.

#[cfg(unix)]
use crate::support::interrupted;
use crate::support::{Folder, Quad, assert_named, assert_says, asset, bake, json, number, pixel_bits, run};

const SMALL: [&str; 4] = ["--samples", "64", "--resolution", "32"];

#[test]
fn the_same_seed_bakes_the_same_light_map() {
    let baked = |seed: &str| {
        let folder = Folder::new();
        let found = bake(&folder, &asset("cornell.gltf"), &[&SMALL[..], &["--seed", seed]].concat());
        assert_eq!(found.code, Some(0), "{found:?}");
        pixel_bits(&folder.path("out.exr"))
    };
    let first = baked("7");
    assert_eq!((first.0, first.1), (32, 32));
    assert!(first == baked("7"), "two bakes with one seed differ");
    assert!(first != baked("8"), "the seed makes no difference");
}

/// By the cosine some texels of the box need far more rays than others.
#[test]
fn texels_that_have_converged_stop_where_an_error_is_asked_for() {
    let baked = |more: &[&str]| {
        let folder = Folder::new();
        let report = folder.text("r.json");
        let common = ["--resolution", "32", "--sampling", "cosine", "--error", "0.1", "--report", &report];
        let found = bake(&folder, &asset("cornell.gltf"), &[&common[..], more].concat());
        assert_eq!(found.code, Some(0), "{found:?}");
        let report = json(&folder.path("r.json"));
        assert!(number(&report["estimated_error"]) <= 0.1, "{report}");
        ["samples_per_texel", "most_samples", "rays"].map(|name| number(&report[name]))
    };
    let [adaptive, even] = [baked(&[]), baked(&["--no-adaptive"])];
    assert!(adaptive[0] < adaptive[1] && even[0] == even[1], "{adaptive:?}, {even:?}");
    assert!(adaptive[2] < even[2], "{adaptive:?}, {even:?}");
}

#[test]
fn every_output_is_written_and_the_report_has_its_names() {
    let folder = Folder::new();
    let (report, preview) = (folder.text("r.json"), folder.text("p.png"));
    let more = [&SMALL[..], &["--seed", "3", "--report", &report, "--preview", &preview]].concat();
    let found = bake(&folder, &asset("courtyard.gltf"), &more);
    assert_eq!(found.code, Some(0), "{found:?}");
    assert_eq!(folder.names(), ["out.exr", "p.png", "r.json"]);
    assert_says(&found.stdout, &["out.exr", "p.png", "r.json"]);
    let picture = image::open(folder.path("p.png")).expect("is an image");
    let (width, height, _) = pixel_bits(&folder.path("out.exr"));
    assert_eq!((picture.width(), picture.height()), (width, height));

    let report = json(&folder.path("r.json"));
    assert_named(&report, &["scene", "device", "driver", "backend"]);
    assert_eq!(report["resolution"], serde_json::json!([width, height]));
    for name in ["texels", "epochs", "samples_per_texel", "rays", "mrays_per_s"] {
        assert!(number(&report[name]) > 0.0, "{name}: {report}");
    }
    assert!(number(&report["texels"]) <= f64::from(width * height));
    let seconds = &report["seconds"];
    let parts = ["load", "bvh", "gbuffer", "aiming", "direct", "importance", "bake", "resolve", "write", "compile"];
    assert!(parts.iter().all(|part| number(&seconds[part]) >= 0.0), "{report}");
    assert!(number(&seconds["total"]) >= number(&seconds["bake"]), "{report}");
    let rate = number(&report["rays"]) / number(&seconds["bake"]) * 1e-6;
    assert!((rate / number(&report["mrays_per_s"]) - 1.0).abs() < 0.01, "{rate}: {report}");
    assert!(report["estimated_error"].is_null() || number(&report["estimated_error"]) >= 0.0);
    let (sampling, shares) = (&report["sampling"], &report["sampling"]["shares"]);
    let sum: f64 = ["cosine", "source", "sky"].iter().map(|technique| number(&shares[technique])).sum();
    assert!((sum - 1.0).abs() < 1e-9 && (0.0..=1.0).contains(&number(&sampling["alpha"])), "{report}");
    assert!(sampling["visible"]["source"].is_null() || number(&sampling["visible"]["source"]) <= 1.0, "{report}");
    assert!(report["features"].as_array().is_some_and(|used| used.contains(&"IMPORTANCE".into())), "{report}");
    let is_told = |item: &serde_json::Value| item["what"] == "no map of the sky" && item["bytes_saved"].is_u64();
    assert!(report["left_out"].as_array().is_some_and(|left_out| left_out.iter().any(is_told)), "{report}");
    assert!(sampling["visible"]["sky"].is_null() && number(&sampling["pyramids"]) >= 1.0, "{report}");
    assert!(report["warnings"].is_array());
    assert_eq!((&report["seed"], &report["interrupted"]), (&3.into(), &false.into()));
    let instances = report["instances"].as_array().expect("is a list");
    assert!(instances.len() > 1, "{report}");
    assert!(instances.iter().all(|i| i["name"].is_string() && number(&i["scale"][0]) >= 0.0), "{report}");
    assert!(instances.iter().all(|i| i["offset"].as_array().is_some_and(|offset| offset.len() == 2)), "{report}");
}

#[test]
fn quiet_says_nothing() {
    let folder = Folder::new();
    let found = bake(&folder, &asset("furnace.gltf"), &[&SMALL[..], &["--quiet"]].concat());
    assert_eq!(found.code, Some(0), "{found:?}");
    assert!(found.stdout.is_empty(), "{found:?}");
    assert!(found.stderr.lines().all(|line| line.starts_with("warning: ")), "{found:?}");
}

#[test]
fn a_time_ends_a_bake() {
    let folder = Folder::new();
    let report = folder.text("r.json");
    let more = ["--time", "500ms", "--samples", "1000000000", "--resolution", "32", "--report", &report];
    let found = bake(&folder, &asset("cornell.gltf"), &more);
    assert_eq!(found.code, Some(0), "{found:?}");
    assert_eq!(json(&folder.path("r.json"))["interrupted"], false);
}

#[test]
fn a_glb_bakes_as_the_same_gltf_does() {
    let folder = Folder::new();
    let scene = Quad::default().write(&folder);
    let found = bake(&folder, &scene, &SMALL);
    assert_eq!(found.code, Some(0), "{found:?}");
    let expected = pixel_bits(&folder.path("out.exr"));
    let scene = folder.write("quad.glb", Quad::default().glb());
    let found = bake(&folder, &scene, &SMALL);
    assert_eq!(found.code, Some(0), "{found:?}");
    assert!(pixel_bits(&folder.path("out.exr")) == expected);
}

/// A signal before anything is baked leaves no light map; how long that takes depends on the machine.
#[cfg(unix)]
#[test]
fn an_interrupted_bake_keeps_what_is_there() {
    for wait in [2, 8, 30, 90] {
        let folder = Folder::new();
        let (output, report) = (folder.text("out.exr"), folder.text("r.json"));
        let options = ["--time", "1h", "--report", &report, "--resolution", "64"];
        let found = interrupted(["bake", &asset("cornell.gltf"), "-o", &output].iter().chain(&options), wait);
        assert_eq!(found.code, Some(130), "{found:?}");
        assert!(found.stderr.contains("interrupted"), "{found:?}");
        if !folder.path("out.exr").exists() {
            assert!(found.stderr.contains("nothing is written"), "{found:?}");
            assert!(folder.names().is_empty());
            continue;
        }
        assert!(found.stderr.contains("holds what was baked until then"), "{found:?}");
        let (width, height, pixels) = pixel_bits(&folder.path("out.exr"));
        assert_eq!((width, height, pixels.len()), (64, 64, 64 * 64));
        assert_eq!(json(&folder.path("r.json"))["interrupted"], true);
        assert_eq!(folder.names(), ["out.exr", "r.json"]);
        return;
    }
    panic!("nothing was baked in a minute and a half");
}

#[test]
fn info_describes_devices_and_a_scene() {
    let found = run(["info", &asset("courtyard.gltf"), "--resolution", "64", "--sky", "1,1,1"]);
    assert_eq!(found.code, Some(0), "{found:?}");
    let names = [
        "device 0",
        "driver",
        "back ends",
        "largest buffer",
        "scene ",
        "meshes",
        "instances",
        "triangles",
        "emissive triangles",
        "mapped triangles",
        "unmapped triangles",
        "lights",
        "sky",
        "texels to bake",
        "total",
        "left out",
    ];
    assert_says(&found.stdout, &names);
    for wrong in ["no analytic lights", "every bounce traces", "no textures of albedo"] {
        assert!(!found.stdout.contains(wrong), "{wrong}: {found:?}");
    }
    let found = run(["info", "no/such.gltf"]);
    assert_eq!(found.code, Some(1), "{found:?}");
    assert!(found.stderr.contains("no/such.gltf"), "{found:?}");
}
