//! `lightoven bench` on the project's own scenes: its figures hang together; how large they are is the machine's affair.

use crate::support::{Folder, Quad, assert_named, assert_refused, assert_says, asset, json, number, run};
use serde_json::Value;

const SMALL: [&str; 6] = ["--resolution", "32", "--rays", "100000", "--rounds", "3"];

fn assert_spread(spread: &Value) {
    let [least, median, most] = ["least", "median", "most"].map(|name| number(&spread[name]));
    assert!(0.0 < least && least <= median && median <= most, "{spread}");
}

/// Of a query; where there is no ray query there is none of its figures.
fn assert_speeds(report: &Value, query: &str) {
    let spread = &report["spread"][query];
    for who in ["software", "ray_query", "cpu"] {
        assert_eq!(report[query][who], spread[who]["median"], "{who}: {report}");
        if who != "ray_query" || !spread[who].is_null() {
            assert_spread(&spread[who]);
        }
    }
    for (ratio, who) in [("software_to_cpu", "cpu"), ("software_to_ray_query", "ray_query")] {
        assert_eq!(spread[ratio].is_null(), spread[who].is_null(), "{report}");
        if spread[ratio].is_null() {
            continue;
        }
        assert_spread(&spread[ratio]);
        // Every round's ratio lies within what the slowest and the fastest of all rounds give.
        let [software, other] = ["software", who].map(|who| &spread[who]);
        let bound = |ours: &str, theirs: &str| number(&software[ours]) / number(&other[theirs]);
        assert!(number(&spread[ratio]["least"]) >= bound("least", "most") * 0.999_999, "{report}");
        assert!(number(&spread[ratio]["most"]) <= bound("most", "least") * 1.000_001, "{report}");
    }
}

#[test]
fn figures_are_printed_and_reported() {
    let folder = Folder::new();
    let found = run(["bench", &asset("cornell.gltf"), "--report", &folder.text("r.json")].iter().chain(&SMALL));
    assert_eq!(found.code, Some(0), "{found:?}");
    let says = ["Mrays/s", "closest hit, software", "any hit, obvhs", "a pass of 32 rays", "32 x 32"];
    assert_says(&found.stdout, &says);
    let report = json(&folder.path("r.json"));
    assert_named(&report, &["scene", "device", "driver"]);
    assert_eq!((&report["rays"], &report["rounds"]), (&100_000.into(), &3.into()));
    assert!(report["cpu"]["threads"].as_u64().is_some_and(|threads| threads > 0), "{report}");
    assert_eq!(report["order"], "bake");
    assert_speeds(&report, "closest");
    assert_speeds(&report, "occluded");
    for ratio in ["software_to_cpu", "software_to_ray_query"] {
        assert_eq!(report[ratio], report["spread"]["closest"][ratio]["median"], "{report}");
    }

    let agreement = &report["agreement"];
    for who in ["software", "cpu"] {
        // A box open toward the viewer.
        assert!((0.5..1.0).contains(&number(&agreement["hits"][who])), "{report}");
        assert!(number(&agreement["mean_distance"][who]) > 0.0, "{report}");
        assert!(number(&agreement["differing"][who]) <= 1e-4, "{report}");
    }
    let gather = &report["gather"];
    assert_eq!((&gather["resolution"], &gather["rays_per_texel"]), (&serde_json::json!([32, 32]), &32.into()));
    assert_spread(&gather["milliseconds"]);
    let texels = number(&gather["texels"]);
    let slowest = texels * 32.0 * 1e-6 / (number(&gather["milliseconds"]["most"]) * 1e-3);
    assert!(texels > 100.0 && (slowest / number(&gather["mrays_per_s"]["least"]) - 1.0).abs() < 1e-9, "{report}");
}

#[test]
fn one_back_end_and_a_random_order_may_be_asked_for() {
    let folder = Folder::new();
    let more = ["--backend", "software", "--order", "random", "--rounds", "1", "--report", &folder.text("r.json")];
    let found = run(["bench", &asset("courtyard.gltf"), "--resolution", "32", "--rays", "20000"].iter().chain(&more));
    assert_eq!(found.code, Some(0), "{found:?}");
    let report = json(&folder.path("r.json"));
    assert!(report["closest"]["ray_query"].is_null() && report["software_to_ray_query"].is_null(), "{report}");
    assert_eq!((&report["gather"]["backend"], &report["order"]), (&"software".into(), &"random".into()));
    assert_says(&found.stdout, &["random order"]);
    assert!(number(&report["instances"]) > 1.0 && number(&report["agreement"]["differing"]["cpu"]) <= 1e-4, "{report}");
}

#[test]
fn bad_usage_is_named_with_what_is_allowed() {
    let folder = Folder::new();
    let scene = Quad::default().write(&folder);
    let bad = [
        ("--rays", "0", "'0'", "1 to 16777216"),
        ("--rays", "20000000", "'20000000'", "1 to 16777216"),
        ("--rounds", "0", "'0'", "1 to 1000"),
        ("--rounds", "-2", "'-2'", "1 to 1000"),
        ("--resolution", "0", "'0'", "1 to 16384"),
        ("--backend", "magic", "'magic'", "ray-query"),
        ("--order", "sorted", "'sorted'", "random"),
        ("--growth", "leaves", "'leaves'", "texels"),
        ("--most-triangles", "5000", "--growth", "required"),
        ("--most-texels", "256", "--growth", "required"),
    ];
    assert_refused("bench", &[], &bad);
    let found = run(["bench", &scene, "--report", &scene]);
    assert_eq!(found.code, Some(2), "{found:?}");
    assert!(found.stderr.contains("same file as the scene"), "{found:?}");
}

#[test]
fn features_tell_what_each_of_them_costs() {
    let folder = Folder::new();
    let more = ["--features", "--backend", "software", "--rounds", "2", "--report", &folder.text("r.json")];
    let small = ["--resolution", "32", "--rays", "20000"];
    let found = run(["bench", &asset("furnace.gltf")].iter().chain(&more).chain(&small));
    assert_eq!(found.code, Some(0), "{found:?}");
    assert_says(&found.stdout, &["switched on", "none", "instances", "sky_map", "all"]);
    let report = json(&folder.path("r.json"));
    let rows = report["rows"].as_array().expect("is a list");
    let names = |row: &Value| row["switched_on"].as_array().map_or(0, Vec::len);
    let (least, most) = (&rows[0], rows.last().expect("has rows"));
    assert!(names(least) == 0 && names(most) == rows.len() - 2, "{report}");
    for row in rows {
        assert_spread(&row["mrays_per_s"]);
        assert_spread(&row["time_ratio"]);
        assert!(number(&row["set_up_seconds"]) >= 0.0, "{report}");
        assert!(number(&row["bytes"]) >= number(&least["bytes"]), "{report}");
        assert!(number(&row["spirv_bytes"]) >= number(&least["spirv_bytes"]), "{report}");
    }
    assert!(number(&most["bytes"]) > number(&least["bytes"]) * 1.2, "{report}");
    assert!(number(&most["spirv_bytes"]) > number(&least["spirv_bytes"]) * 1.2, "{report}");
}

#[test]
fn features_of_a_dark_scene_cost_nothing_to_tell() {
    let folder = Folder::new();
    let dark = folder.write("dark.gltf", r#"{"asset":{"version":"2.0"}}"#);
    let found = run(["bench", &dark, "--features"]);
    assert_eq!(found.code, Some(1), "{found:?}");
    assert_says(&found.stderr, &["'dark'", "nothing to measure"]);
    let found = run(["bench", &dark, "--sampling", "cosine"]);
    assert_eq!(found.code, Some(2), "{found:?}");
    assert_says(&found.stderr, &["--sampling", "--features", "required"]);
    let found = run(["bench", &dark, "--features", "--sampling", "all"]);
    assert_eq!(found.code, Some(2), "{found:?}");
    assert_says(&found.stderr, &["--sampling", "'all'", "allowed is auto, cosine"]);
}
