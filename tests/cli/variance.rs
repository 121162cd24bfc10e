//! `lightoven variance` on the project's own scenes.

use crate::support::{Folder, Quad, assert_named, assert_refused, assert_says, asset, json, number, run};

const SMALL: [&str; 8] = ["--resolution", "32", "--samples", "65", "--seeds", "3", "--reference-samples", "1024"];

#[test]
fn figures_are_printed_and_reported() {
    let folder = Folder::new();
    let report = folder.text("r.json");
    let scene = asset("cornell.gltf");
    let more = ["--sampling", "cosine,mixture=0.5,cosine", "--report", &report];
    let found = run(["variance", &scene].iter().chain(&SMALL).chain(&more));
    assert_eq!(found.code, Some(0), "{found:?}");
    let says = ["estimated error", "3 of 128 samples", "mean variance", "median SD", "Mrays/s", "mixture=0.5"];
    assert_says(&found.stdout, &says);
    let report = json(&folder.path("r.json"));
    assert_named(&report, &["scene", "device", "driver", "backend"]);
    assert_eq!((&report["resolution"], &report["seeds"]), (&serde_json::json!([32, 32]), &3.into()));
    assert!((1.0..=1024.0).contains(&number(&report["texels"])), "{report}");
    let reference = &report["reference"];
    assert_eq!((&reference["seed"], number(&reference["samples_per_texel"])), (&0.into(), 1024.0));
    let error = number(&reference["estimated_error"]);
    let adds = number(&reference["adds_mean_variance"]);
    assert!(error > 0.0 && (adds / (128.0 * error * error) - 1.0).abs() < 1e-6, "{report}");

    let rows = report["samplings"].as_array().expect("is a list");
    let names: Vec<_> = rows.iter().map(|row| row["sampling"].as_str().expect("is text")).collect();
    assert_eq!(names, ["cosine", "mixture=0.5", "cosine"]);
    for row in rows {
        assert_eq!((number(&row["samples_per_texel"]), &row["not_finite"]), (128.0, &0.into()));
        for name in ["mean_variance", "median_sd", "mrays_per_s", "mean_variance_ratio", "median_sd_ratio"] {
            assert!(number(&row[name]) > 0.0, "{name}: {row}");
        }
        assert!(number(&row["p90_sd"]) >= number(&row["median_sd"]), "{row}");
        // 3 bakes of 128 samples for each of some 500 texels leave about 1 % of noise.
        assert!((number(&row["energy_ratio"]) - 1.0).abs() < 0.1, "{row}");
    }
    // The same seeds by the same way: the same bakes.
    assert_eq!(rows[0]["mean_variance"], rows[2]["mean_variance"]);
    assert_eq!((number(&rows[0]["mean_variance_ratio"]), number(&rows[2]["median_sd_ratio"])), (1.0, 1.0));
}

#[test]
fn values_out_of_range_are_named_with_what_is_allowed() {
    let bad = [
        ("--sampling", "cosine,best", "'best'", "importance"),
        ("--sampling", "mixture=2", "'mixture=2'", "0.1 to 1"),
        ("--samples", "0", "'0'", "1 to 1048576"),
        ("--samples", "2000000", "'2000000'", "1 to 1048576"),
        ("--seeds", "1", "'1'", "2 to 1000"),
        ("--seeds", "1001", "'1001'", "2 to 1000"),
        ("--seeds", "-2", "'-2'", "2 to 1000"),
        ("--reference-samples", "0", "'0'", "from 1"),
        ("--bounces", "many", "'many'", "auto"),
        ("--resolution", "0", "'0'", "1 to 16384"),
    ];
    assert_refused("variance", &[], &bad);
}

#[test]
fn what_cannot_be_measured_fails() {
    let folder = Folder::new();
    // A square alone, which shines and receives nothing.
    let scene = Quad::default().write(&folder);
    let found = run(["variance", &scene].iter().chain(&SMALL));
    assert_eq!(found.code, Some(1), "{found:?}");
    assert!(found.stderr.contains("quad.gltf") && found.stderr.contains("is lit"), "{found:?}");
    let dark = folder.write("dark.gltf", r#"{"asset":{"version":"2.0"}}"#);
    for command in ["variance", "converge"] {
        let found = run([command, &dark, "--resolution", "32"]);
        assert_eq!(found.code, Some(1), "{found:?}");
        assert_says(&found.stderr, &["'dark'", "no noise to measure"]);
    }
    let found = run(["variance", &scene, "--report", &scene]);
    assert_eq!(found.code, Some(2), "{found:?}");
    assert!(found.stderr.contains("same file as the scene"), "{found:?}");
}

#[cfg(unix)]
#[test]
fn an_interrupted_measurement_writes_nothing() {
    let scene = asset("cornell.gltf");
    let options = ["--resolution", "64", "--seeds", "1000", "--samples", "1000000"];
    crate::support::assert_no_figures_when_interrupted(&[&["variance", scene.as_str()][..], &options].concat());
}
