//! `lightoven compare` on images of known difference.

use crate::support::{Folder, json, run, tool};
use lightoven::baker::LightMap;
use lightoven::io::exr::write_light_map;
use std::process::Stdio;

/// A 4 x 2 image; its texels are `value(texel)`, the last one not covered.
fn image(folder: &Folder, name: &str, value: impl Fn(usize) -> f32) -> String {
    let pixels = (0..8).map(|i| [value(i), value(i), value(i), if i < 7 { 1.0 } else { 0.0 }]).collect();
    let light_map = LightMap { width: 4, height: 2, pixels };
    write_light_map(&folder.path(name), &light_map, &Default::default()).expect("can be written");
    folder.text(name)
}

#[test]
fn figures_are_printed_and_reported() {
    let folder = Folder::new();
    let a = image(&folder, "a.exr", |i| if i == 5 { 1.5 } else { 1.1 });
    let b = image(&folder, "b.exr", |_| 0.5);
    let report = folder.text("r.json");
    let found = run(["compare", &a, &b, "--scale-b", "2", "--report", &report]);
    assert_eq!(found.code, Some(0), "{found:?}");
    assert!(found.stdout.contains("texels                      7"), "{found:?}");
    assert!(found.stdout.contains("column 1, row 1"), "{found:?}");
    let report = json(&folder.path("r.json"));
    let number = |name: &str| report[name].as_f64().expect("is a number");
    assert_eq!(report["texels"], 7);
    assert!((number("energy_ratio") - 8.1 / 7.0).abs() < 1e-6);
    assert!((number("median_relative_difference") - 0.1).abs() < 1e-6);
    assert!((number("rmse") - (0.31_f64 / 7.0).sqrt()).abs() < 1e-6);
    assert!((number("rel_mse") - 0.31 / 7.0 / 1.01).abs() < 1e-6);
    assert!((number("largest_difference") - 0.5).abs() < 1e-6);
    let ranges = report["by_brightness"].as_array().expect("is a list");
    assert_eq!(ranges.iter().map(|range| range["texels"].as_u64().expect("is a number")).sum::<u64>(), 7);
    assert_eq!((&ranges[0]["from"], &ranges[0]["to"]), (&0.01.into(), &0.1.into()));
    assert!(ranges[0]["energy_ratio"].is_null() && ranges[3]["to"].is_null());
    assert!((ranges[2]["median_ratio"].as_f64().expect("is a number") - 1.1).abs() < 1e-6);
    assert!(found.stdout.contains("1.15714       1.10000"), "{found:?}");
}

/// The encoding that Blender writes is told on stderr, with the file's name.
#[test]
fn a_display_encoded_reference_is_decoded_and_said() {
    use exr::prelude::{AttributeValue, Image, SpecificChannels, Text, Vec2, WritableImage};
    let folder = Folder::new();
    let a = image(&folder, "a.exr", |_| 0.214_041_14);
    let channels = SpecificChannels::rgba(|_: Vec2<usize>| (0.5_f32, 0.5_f32, 0.5_f32, 1.0_f32));
    let mut b = Image::from_channels((4, 2), channels);
    let name = Text::new_or_panic("colorInteropID");
    let value = AttributeValue::Text(Text::new_or_panic("srgb_rec709_display"));
    b.layer_data.attributes.other.insert(name, value);
    b.write().to_file(folder.path("b.exr")).expect("can be written");
    let found = run(["compare", &a, &folder.text("b.exr")]);
    assert_eq!(found.code, Some(0), "{found:?}");
    assert!(found.stdout.contains("energy ratio                1.00000"), "{found:?}");
    assert!(found.stderr.contains("warning: ") && found.stderr.contains("b.exr' is sRGB-encoded"), "{found:?}");
}

#[test]
fn what_cannot_be_compared_fails() {
    let folder = Folder::new();
    let a = image(&folder, "a.exr", |_| 1.0);
    let black = image(&folder, "black.exr", |_| 0.0);
    let pixels = vec![[1.0; 4]; 4];
    write_light_map(&folder.path("small.exr"), &LightMap { width: 2, height: 2, pixels }, &Default::default())
        .expect("can be written");
    let text = folder.write("text.exr", "not an image");
    let cases = [
        (folder.text("small.exr"), "is 4 x 2 and"),
        (black, "cannot compare"),
        (text, "text.exr"),
        (folder.text("missing.exr"), "missing.exr"),
    ];
    for (b, says) in cases {
        let found = run(["compare", &a, &b]);
        assert_eq!(found.code, Some(1), "{found:?}");
        assert!(found.stderr.contains(says) && found.stdout.is_empty(), "{found:?}");
    }
    let found = run(["compare", &a, &a, "--scale-b", "-1"]);
    assert_eq!(found.code, Some(2), "{found:?}");
}

#[test]
fn a_reader_that_has_gone_is_no_failure() {
    let folder = Folder::new();
    let a = image(&folder, "a.exr", |_| 1.0);
    let (reader, writer) = std::io::pipe().expect("is made");
    drop(reader);
    let child = tool(["compare", &a, &a]).stdout(writer).stderr(Stdio::piped()).spawn().expect("the tool starts");
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(output.stderr.is_empty(), "{output:?}");
}
