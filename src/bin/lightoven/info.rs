//! `lightoven info`: what there is to bake with, and what a bake of a scene would do.

use crate::Ending;
use crate::arguments::{Info, SceneArguments};
use crate::{load, messages};
use lightoven::Result;
use lightoven::baker::{BakeSettings, ErrorEstimate, MemoryEstimate, estimate_memory};
use lightoven::gpu::DeviceInfo;
use lightoven::headless::devices;
use lightoven::scene::{Atlas, LightKind, Scene, Sky};
use std::fmt::{Display, Write as _};

/// Lists devices, then the scene. What can be said is said before the error of what cannot.
pub(crate) fn run(arguments: &Info) -> Result<Ending> {
    let found = devices();
    if let Ok(devices) = &found {
        messages::stdout(&device_text(devices))?;
    }
    if let Some(path) = &arguments.scene {
        let scene = load::scene(path, &arguments.how)?;
        messages::stdout(&scene_text(&scene))?;
        messages::stdout(&bake_text(&scene, &arguments.how)?)?;
    }
    found.map(|_| Ending::Done)
}

/// Collects lines; writing to a string cannot fail.
#[derive(Default)]
struct Text(String);

impl Text {
    fn line(&mut self, line: impl Display) {
        let _ = writeln!(self.0, "{line}");
    }

    fn entry(&mut self, name: &str, value: impl Display) {
        let _ = writeln!(self.0, "  {name:<20} {value}");
    }
}

fn device_text(devices: &[DeviceInfo]) -> String {
    let mut text = Text::default();
    for device in devices {
        let (major, minor, patch) = device.api_version;
        text.line(format_args!("device {}: {}", device.index, device.name));
        text.entry("kind", device.kind);
        text.entry("Vulkan", format_args!("{major}.{minor}.{patch}"));
        text.entry("driver", &device.driver);
        match &device.usable {
            Ok(()) => text.entry("back ends", if device.ray_query { "software, ray-query" } else { "software" }),
            Err(why) => text.entry("not usable", why),
        }
        text.entry("memory", bytes(device.device_memory_bytes));
        text.entry("largest buffer", bytes(device.max_storage_buffer_bytes));
        text.entry("largest image", format_args!("{0} x {0}", device.max_image_side));
    }
    text.0
}

/// Triangles of all instances, counted by what they do.
#[derive(Debug, Default, PartialEq, Eq)]
struct Triangles {
    mapped: usize,
    unmapped: usize,
    emissive: usize,
}

fn count_triangles(scene: &Scene) -> Triangles {
    let mut count = Triangles::default();
    for instance in scene.instances() {
        let mesh = &scene.meshes()[instance.mesh];
        let mapped = mesh.light_map_uvs().iter().flatten().count();
        count.mapped += mapped;
        count.unmapped += mesh.len() - mapped;
        let emissive = |material: &&u32| scene.materials()[**material as usize].is_emissive();
        count.emissive += mesh.materials().iter().filter(emissive).count();
    }
    count
}

/// Point, spot and directional lights.
fn count_lights(scene: &Scene) -> [usize; 3] {
    let mut count = [0; 3];
    for light in scene.lights() {
        let kind = match light.kind {
            LightKind::Point { .. } => 0,
            LightKind::Spot { .. } => 1,
            LightKind::Directional { .. } => 2,
        };
        count[kind] += 1;
    }
    count
}

fn scene_text(scene: &Scene) -> String {
    let mut text = Text::default();
    let triangles = count_triangles(scene);
    let [point, spot, directional] = count_lights(scene);
    text.line(format_args!("scene {}", scene.name()));
    text.entry("meshes", scene.meshes().len());
    text.entry("instances", scene.instances().len());
    text.entry("triangles", scene.triangle_count());
    text.entry("emissive triangles", triangles.emissive);
    text.entry("mapped triangles", triangles.mapped);
    text.entry("unmapped triangles", format_args!("{} (block and emit light, receive none)", triangles.unmapped));
    text.entry("materials", scene.materials().len());
    text.entry("textures", scene.textures().len());
    text.entry("lights", format_args!("{point} point, {spot} spot, {directional} directional"));
    match scene.sky() {
        Sky::Black => text.entry("sky", "black"),
        Sky::Constant(radiance) => text.entry("sky", radiance),
        Sky::Map(map) => text.entry("sky", format_args!("map of {} x {}", map.width, map.height)),
    }
    text.0
}

fn bake_text(scene: &Scene, arguments: &SceneArguments) -> Result<String> {
    // As `bake` does unless it is told otherwise: to an error.
    let settings =
        BakeSettings { resolution: arguments.resolution(), error: ErrorEstimate::Adaptive, ..BakeSettings::default() };
    let (atlas, memory) = estimate_memory(scene, &settings)?;
    let mut text = Text::default();
    layout_text(&mut text, &atlas);
    memory_text(&mut text, &memory);
    let used: Vec<String> = memory.features.iter_names().map(|(name, _)| name.to_lowercase()).collect();
    text.entry("used", if used.is_empty() { "nothing".into() } else { used.join(", ") });
    text.line("left out");
    let left_out = memory.left_out(scene, &atlas);
    for (what, saved) in &left_out {
        let saved = if *saved > 0 { format!(" ({} saved)", bytes(*saved)) } else { String::new() };
        text.line(format_args!("  {what}{saved}"));
    }
    if left_out.is_empty() {
        text.line("  nothing");
    }
    if let Some(warning) = load::layout_warning(&atlas) {
        tracing::warn!("{warning}");
    }
    Ok(text.0)
}

fn layout_text(text: &mut Text, atlas: &Atlas) {
    text.line("light map");
    text.entry("size", format_args!("{} x {}", atlas.size.x, atlas.size.y));
    text.entry("texels to bake", format_args!("about {} (those whose centre is covered)", atlas.covered_texels));
    let layout = if atlas.shared { "as the scene has it" } else { "a rectangle for each instance" };
    text.entry("layout", layout);
}

fn memory_text(text: &mut Text, memory: &MemoryEstimate) {
    text.line("device memory of a bake");
    for (name, size) in &memory.parts {
        text.entry(name, bytes(*size));
    }
    text.entry("total", bytes(memory.total()));
    for (name, size) in &memory.set_up {
        text.entry(name, format_args!("{} (set-up)", bytes(*size)));
    }
}

/// Bytes in the largest unit of 1024 that leaves at least 1.
fn bytes(count: u64) -> String {
    let (mut value, mut unit) = (count as f64, "bytes");
    for larger in ["KiB", "MiB", "GiB", "TiB"] {
        if value < 1024.0 {
            break;
        }
        (value, unit) = (value / 1024.0, larger);
    }
    if unit == "bytes" { format!("{count} bytes") } else { format!("{value:.1} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        assert_eq!([bytes(0), bytes(1023), bytes(1 << 27)], ["0 bytes", "1023 bytes", "128.0 MiB"]);
        assert_eq!(bytes(u64::MAX), "16777216.0 TiB");
    }
}
