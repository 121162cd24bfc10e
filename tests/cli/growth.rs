//! `lightoven bench --growth` on the project's own scenes: sizes are what was asked for, and the figures hang together.

use crate::support::{Folder, assert_named, assert_refused, assert_says, asset, json, number, run};
use serde_json::Value;

const FEW: [&str; 4] = ["--rays", "20000", "--rounds", "2"];

const COSTS: [&str; 9] = [
    "bvh_seconds",
    "gbuffer_seconds",
    "aiming_seconds",
    "total_seconds",
    "closest_ns",
    "occluded_ns",
    "gather_ns",
    "host_bytes",
    "device_bytes",
];

/// Rows of a growth, each checked; exponents are named.
fn rows(growth: &Value) -> &Vec<Value> {
    let rows = growth["rows"].as_array().expect("is a list");
    for row in rows {
        assert!(row["failed"].is_null() && number(&row["texels"]) > 0.0, "{row}");
        for name in ["closest_ns", "occluded_ns", "gather_ns"] {
            let [least, median, most] = ["least", "median", "most"].map(|part| number(&row[name][part]));
            assert!(0.0 < least && least <= median && median <= most, "{row}");
        }
        let parts = ["gbuffer_seconds", "aiming_seconds"].map(|part| number(&row["set_up"][part]));
        assert!(parts.iter().sum::<f64>() <= number(&row["set_up"]["total_seconds"]), "{row}");
        assert!(number(&row["bvh_seconds"]) > 0.0 && number(&row["device_bytes"]) > 0.0, "{row}");
        assert!(row["host_bytes"].is_null() || row["host_bytes"].is_u64(), "{row}");
    }
    let exponents = growth["exponents"].as_array().expect("is a list");
    let names: Vec<_> = exponents.iter().map(|exponent| &exponent["cost"]).collect();
    assert_eq!(names, COSTS);
    rows
}

fn exponent(growth: &Value, cost: &str) -> f64 {
    let exponents = growth["exponents"].as_array().expect("is a list");
    let found = exponents.iter().find(|exponent| exponent["cost"] == cost).expect("is named");
    number(&found["exponent"])
}

#[test]
fn triangles_and_texels_grow() {
    let folder = Folder::new();
    let sizes = ["--most-triangles", "20000", "--most-texels", "256", "--resolution", "64"];
    let more = ["--growth", "both", "--report", &folder.text("r.json")];
    let scene = asset("cornell.gltf");
    let found = run(["bench", &scene].iter().chain(&FEW).chain(&sizes).chain(&more));
    assert_eq!(found.code, Some(0), "{found:?}");
    let says = ["with the triangles", "with the texels", "bvh s", "device MiB grow as texels^", "from 2 sizes"];
    assert_says(&found.stdout, &says);

    let report = json(&folder.path("r.json"));
    assert_named(&report, &["scene", "device", "driver", "backend"]);
    assert_eq!((&report["rays"], &report["rounds"]), (&20000.into(), &2.into()));
    let triangles = rows(&report["triangles"]);
    assert_eq!(triangles.len(), 3);
    for (row, about) in triangles.iter().zip([1024.0_f64, 4096.0, 16384.0]) {
        assert!((number(&row["triangles"]) / about).ln().abs() < 0.25, "{row}");
        assert_eq!(row["resolution"], serde_json::json!([64, 64]));
    }
    // A node is 64 bytes, about one for two triangles.
    let nodes = number(&triangles[2]["node_bytes"]) / number(&triangles[2]["triangles"]);
    assert!((16.0..64.0).contains(&nodes), "{report}");
    let texels = rows(&report["texels"]);
    let sides: Vec<_> = texels.iter().map(|row| number(&row["resolution"][0])).collect();
    assert_eq!(sides, [128.0, 256.0]);
    // Images of the light map's size are nearly all that a small scene takes.
    assert!((exponent(&report["texels"], "device_bytes") - 1.0).abs() < 0.2, "{report}");
}

#[test]
fn one_of_the_two_may_be_asked_for() {
    let folder = Folder::new();
    let more = ["--growth", "triangles", "--most-triangles", "1024", "--resolution", "32"];
    let scene = asset("courtyard.gltf");
    let found = run(["bench", &scene, "--report", &folder.text("r.json")].iter().chain(&FEW).chain(&more));
    assert_eq!(found.code, Some(0), "{found:?}");
    let report = json(&folder.path("r.json"));
    assert!(report["texels"].is_null() && rows(&report["triangles"]).len() == 1, "{report}");
    // One size has no slope.
    let exponents = report["triangles"]["exponents"].as_array().expect("is a list");
    assert!(exponents.iter().all(|exponent| exponent["exponent"].is_null()), "{report}");
}

/// Instances that each need a rectangle find no room in a few texels.
#[test]
fn a_size_that_does_not_fit_is_a_row_that_says_why() {
    let folder = Folder::new();
    let more = ["--growth", "triangles", "--most-triangles", "4096", "--resolution", "2"];
    let scene = asset("courtyard.gltf");
    let found = run(["bench", &scene, "--report", &folder.text("r.json")].iter().chain(&FEW).chain(&more));
    assert_eq!(found.code, Some(0), "{found:?}");
    assert_says(&found.stdout, &["the resolution is 2, too small"]);
    let report = json(&folder.path("r.json"));
    let rows = report["triangles"]["rows"].as_array().expect("is a list");
    assert!(rows.len() == 2 && rows.iter().all(|row| row["bvh_seconds"].is_null()), "{report}");
    assert!(rows.iter().all(|row| row["failed"].as_str().is_some_and(|why| why.contains("too small"))), "{report}");
}

#[test]
fn bad_usage_is_named_with_what_is_allowed() {
    let bad = [
        ("--most-triangles", "1000", "'1000'", "1024 to 67108864"),
        ("--most-triangles", "many", "'many'", "1024 to 67108864"),
        ("--most-triangles", "-1", "'-1'", "1024 to 67108864"),
        ("--most-texels", "127", "'127'", "128 to 16384"),
        ("--most-texels", "20000", "'20000'", "128 to 16384"),
        ("--resolution", "64", "--resolution 64", "triangles and both"),
        ("--texels-per-unit", "2", "--texels-per-unit 2", "triangles and both"),
    ];
    assert_refused("bench", &["--growth", "texels"], &bad);
}

#[cfg(unix)]
#[test]
fn an_interruption_leaves_no_figures() {
    let scene = asset("cornell.gltf");
    let options = ["--growth", "both", "--rounds", "1000"];
    crate::support::assert_no_figures_when_interrupted(&[&["bench", scene.as_str()][..], &options].concat());
}
