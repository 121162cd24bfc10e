//! `lightoven converge` on the project's own scenes. How far a bake comes in a time is the machine's, and not asked for.

use crate::support::{
    Folder, Quad, Run, assert_named, assert_refused, assert_says, asset, json, number, pixel_bits, run,
};
use lightoven::baker::LightMap;
use lightoven::io::exr::write_light_map;
use serde_json::Value;

const SMALL: [&str; 6] = ["--resolution", "32", "--seeds", "2", "--time", "500ms"];

const COLUMNS: &str =
    "sampling,backend,seconds,rays,samples_per_texel,seeds,rmse,relmse,median,p95,bias,bias_noise,efficiency";

fn converge<'a>(scene: &'a str, more: impl IntoIterator<Item = &'a str>) -> Run {
    run(["converge", scene].into_iter().chain(SMALL).chain(more))
}

#[test]
fn figures_are_printed_reported_and_drawn() {
    let folder = Folder::new();
    let [report, csv, plot, reference] = ["r.json", "f.csv", "p.svg", "ref.exr"].map(|name| folder.text(name));
    let outputs = ["--report", &report, "--csv", &csv, "--plot", &plot, "--save-reference", &reference];
    let scene = asset("cornell.gltf");
    let found =
        converge(&scene, ["--sampling", "cosine,mixture=0.5", "--reference-time", "1s"].into_iter().chain(outputs));
    assert_eq!(found.code, Some(0), "{found:?}");
    let says = ["estimated error", "bakes      2 of each", "mixture=0.5, software: ", "relMSE", "its noise"];
    assert_says(&found.stdout, &says);
    assert_eq!(folder.names(), ["f.csv", "p.svg", "r.json", "ref.exr"]);
    assert_eq!(pixel_bits(&folder.path("ref.exr")).0, 32);

    let report = json(&folder.path("r.json"));
    assert_named(&report, &["scene", "device", "driver"]);
    assert_eq!((&report["resolution"], &report["seeds"]), (&serde_json::json!([32, 32]), &2.into()));
    assert!((1.0..=1024.0).contains(&number(&report["texels"])), "{report}");
    assert_eq!(report["interrupted"], false);
    let reference = &report["reference"];
    assert_eq!((&reference["seed"], &reference["sampling"]), (&0.into(), &"auto".into()));
    assert!(number(&reference["seconds"]) >= 1.0 && reference["file"].is_null(), "{report}");
    assert!((number(&reference["relmse"]) / number(&reference["estimated_error"]).powi(2) - 1.0).abs() < 1e-5);

    let variants = report["variants"].as_array().expect("is a list");
    let names: Vec<_> = variants.iter().map(|variant| &variant["sampling"]).collect();
    assert_eq!(names, ["cosine", "mixture=0.5"]);
    let rows = variants.iter().map(check_variant).sum::<usize>();

    let text = std::fs::read_to_string(folder.path("f.csv")).expect("is there");
    let lines: Vec<_> = text.lines().collect();
    assert_eq!((lines[0], lines.len()), (COLUMNS, 1 + rows));
    assert!(lines[1].starts_with("cosine,software,") && lines[rows].starts_with("mixture=0.5,software,"), "{text}");
    assert!(lines.iter().all(|line| line.split(',').count() == COLUMNS.split(',').count()), "{text}");

    let text = std::fs::read_to_string(folder.path("p.svg")).expect("is there");
    let labels = ["seconds of baking", "relMSE against the reference", "slope -1", "cosine, software", "mixture=0.5"];
    assert_says(&text, &labels);
    assert_eq!(text.matches("<circle").count(), rows);
}

/// Each figure of a variant is what the others make it; how many rows it has.
fn check_variant(variant: &Value) -> usize {
    assert_eq!(variant["backend"], "software");
    let rows = variant["rows"].as_array().expect("is a list");
    let last = rows.last().expect("the last time has a row however slow the machine is");
    assert!(number(&last["seconds"]) >= 0.5 && number(&last["seeds"]) == 2.0, "{variant}");
    assert!((number(&variant["floor"]) - number(&last["bias"]).powi(2)).abs() < 1e-12, "{variant}");
    assert!(number(&variant["floor_noise"]) > 0.0, "{variant}");
    let fitted = number(&variant["fitted_rows"]) >= 2.0;
    assert_eq!(variant["slope"].is_null(), !fitted, "{variant}");
    // On a machine that is busy elsewhere two times may have the same samples, and no line through them has a slope.
    let samples: Vec<f64> =
        rows.iter().map(|row| number(&row["samples_per_texel"])).filter(|kept| *kept > 0.0).collect();
    let differ = samples.windows(2).all(|pair| pair[0] < pair[1]);
    assert!(variant["slope_over_samples"].is_null() != fitted || !differ, "{variant}");
    for pair in rows.windows(2) {
        assert!(number(&pair[0]["seconds"]) < number(&pair[1]["seconds"]), "{variant}");
        assert!(number(&pair[0]["rays"]) < number(&pair[1]["rays"]), "{variant}");
    }
    for row in rows {
        let [relmse, seconds] = ["relmse", "seconds"].map(|name| number(&row[name]));
        assert!((number(&row["efficiency"]) * relmse * seconds - 1.0).abs() < 1e-9, "{row}");
        assert!(number(&row["rmse"]) > 0.0 && number(&row["p95"]) >= number(&row["median"]), "{row}");
        let parts = number(&row["bias"]).powi(2) + number(&row["seeds"]) * number(&row["bias_noise"]).powi(2);
        // A bias that noise explains counts as 0.
        assert!(parts >= relmse * (1.0 - 1e-9), "{row}");
        assert_eq!(row["not_finite"], 0);
    }
    rows.len()
}

/// A scene whose every texel receives pi, against a file that says so, then against one that says twice as much.
#[test]
fn a_reference_from_a_file_is_scaled() {
    let folder = Folder::new();
    let scene = asset("furnace.gltf");
    let baked = folder.text("out.exr");
    let found = run(["bake", &scene, "-o", &baked, "--resolution", "32", "--samples", "1024"]);
    assert_eq!(found.code, Some(0), "{found:?}");
    let report = folder.text("r.json");
    for (scale, bias) in [("1", 0.0), ("0.5", 1.0)] {
        let options = ["--sampling", "auto", "--time", "200ms", "--reference", &baked, "--scale-reference", scale];
        let found =
            run(["converge", &scene, "--resolution", "32", "--seeds", "2", "--report", &report].iter().chain(&options));
        assert_eq!(found.code, Some(0), "{found:?}");
        assert!(found.stdout.contains("out.exr' itself is not known"), "{found:?}");
        let report = json(&folder.path("r.json"));
        assert_eq!(
            (&report["reference"]["file"], number(&report["reference"]["scale"])),
            (&baked.clone().into(), scale.parse().expect("is one"))
        );
        assert!(report["reference"]["seconds"].is_null() && report["reference"]["relmse"].is_null(), "{report}");
        let rows = report["variants"][0]["rows"].as_array().expect("is a list");
        let median = number(&rows.last().expect("has rows")["median"]);
        assert!((median - bias).abs() < 0.02, "{report}");
    }
}

#[test]
fn values_out_of_range_are_named_with_what_is_allowed() {
    let bad = [
        ("--sampling", "cosine,best", "'best'", "importance"),
        ("--sampling", "auto,cosine,auto", "'auto'", "once"),
        ("--backend", "software,magic", "'magic'", "ray-query"),
        ("--backend", "auto,auto", "more than once", "once"),
        ("--seeds", "1", "'1'", "2 to 1000"),
        ("--time", "0s", "'0s'", "over 0"),
        ("--time", "soon", "'soon'", "as in 30s"),
        ("--reference-time", "-1s", "'-1s'", "over 0"),
        ("--scale-reference", "0", "'0'", "over 0"),
        ("--scale-reference", "2", "--reference", "required"),
        ("--bounces", "many", "'many'", "auto"),
        ("--resolution", "0", "'0'", "1 to 16384"),
    ];
    assert_refused("converge", &[], &bad);
    let scene = asset("cornell.gltf");
    let found = run(["converge", &scene, "--reference", "a.exr", "--reference-time", "5m"]);
    assert!(found.code == Some(2) && found.stderr.contains("cannot be used with"), "{found:?}");
}

#[test]
fn what_cannot_be_measured_fails() {
    let folder = Folder::new();
    let scene = asset("cornell.gltf");
    let write = |name: &str, side: u32, light: f32| {
        let pixels = vec![[light, light, light, 1.0]; (side * side) as usize];
        let light_map = LightMap { width: side, height: side, pixels };
        write_light_map(&folder.path(name), &light_map, &Default::default()).expect("can be written");
        folder.text(name)
    };
    let small = write("small.exr", 16, 1.0);
    let found = converge(&scene, ["--reference", &small]);
    assert_eq!(found.code, Some(1), "{found:?}");
    assert_says(&found.stderr, &["small.exr' is 16 x 16", "cornell.gltf' 32 x 32", "allowed is one size"]);
    let black = write("black.exr", 32, 0.0);
    let found = converge(&scene, ["--reference", &black]);
    assert_eq!(found.code, Some(1), "{found:?}");
    assert!(found.stderr.contains("cornell.gltf") && found.stderr.contains("lit in the reference"), "{found:?}");
    let found = converge(&scene, ["--reference", "missing.exr"]);
    assert!(found.code == Some(1) && found.stderr.contains("missing.exr"), "{found:?}");
}

#[test]
fn an_output_must_not_replace_an_input_or_another_output() {
    let folder = Folder::new();
    let scene = Quad::default().write(&folder);
    let [one, reference] = [folder.text("one"), folder.write("ref.exr", "a reference")];
    let cases = [
        (["--csv", &scene, "--bounces", "1"], "same file as the scene"),
        (["--plot", &reference, "--reference", &reference], "same file as --reference"),
        (["--csv", &one, "--plot", &one], "--plot is"),
        (["--save-reference", &one, "--report", &one], "same file as --save-reference"),
        (["--plot", "no/such/p.svg", "--bounces", "1"], "there is no folder"),
    ];
    let before = folder.names();
    for (options, says) in cases {
        let found = converge(&scene, options);
        assert!(matches!(found.code, Some(1 | 2)) && found.stderr.contains(says), "{found:?}");
    }
    assert_eq!(folder.names(), before);
}

#[cfg(unix)]
#[test]
fn an_interruption_before_anything_was_measured_writes_nothing() {
    let scene = asset("cornell.gltf");
    let options = ["--resolution", "32", "--time", "1h"];
    crate::support::assert_no_figures_when_interrupted(&[&["converge", scene.as_str()][..], &options].concat());
}

#[cfg(unix)]
#[test]
fn an_interruption_keeps_what_was_measured() {
    let folder = Folder::new();
    let (scene, report) = (asset("cornell.gltf"), folder.text("r.json"));
    let options = ["--resolution", "32", "--time", "1h", "--reference-time", "100ms", "--sampling", "auto"];
    for wait in [4, 12, 40] {
        let found = crate::support::interrupted(["converge", &scene, "--report", &report].iter().chain(&options), wait);
        if found.code.is_none() {
            continue;
        }
        assert_eq!(found.code, Some(130), "{found:?}");
        if folder.names().is_empty() {
            continue;
        }
        assert!(found.stdout.contains("floor not known: one bake"), "{found:?}");
        assert!(found.stderr.contains("what was measured until then"), "{found:?}");
        let report = json(&folder.path("r.json"));
        assert_eq!(report["interrupted"], true);
        let rows = report["variants"][0]["rows"].as_array().expect("is a list");
        assert!(!rows.is_empty() && rows.iter().all(|row| row["seeds"] == 1 && row["bias"].is_null()), "{report}");
        return;
    }
    panic!("nothing was measured within 40 seconds");
}
