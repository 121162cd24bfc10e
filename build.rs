//! Embeds the SPIR-V of `glsl/spirv`, after checking that it was made from the GLSL beside it. With the feature
//! `compile-shaders` it is compiled anew first.

use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const MANIFEST: &str = "glsl/spirv/manifest.txt";
const COMMAND: &str = "cargo build --release --features compile-shaders";
/// A stage that includes this traces rays, and compiles a second time for the hardware back end.
const TRACING: [&str; 2] = ["include/rays.glsl", "include/ray_query.glsl"];
/// The stages of the frame benchmark, which the library knows nothing of.
const BENCHMARK: [&str; 3] = ["glsl/shadow.vert", "glsl/view.frag", "glsl/view.vert"];

fn main() -> Result<()> {
    println!("cargo::rerun-if-changed=glsl");
    let sources = sources()?;
    #[cfg(feature = "compile-shaders")]
    compile::all(&sources)?;
    check(&sources)?;
    embed(&sources)?;
    embed_benchmark()
}

/// Path (with forward slashes) to text, of every GLSL file.
fn sources() -> Result<BTreeMap<String, String>> {
    let mut sources = BTreeMap::new();
    for folder in ["glsl", "glsl/include"] {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_file() {
                let name = path.to_string_lossy().replace('\\', "/");
                sources.insert(name, fs::read_to_string(&path)?.replace("\r\n", "\n"));
            }
        }
    }
    Ok(sources)
}

fn is_stage(path: &str) -> bool {
    [".comp", ".vert", ".frag"].iter().any(|stage| path.ends_with(stage))
}

fn module_path(source: &str, hardware: bool) -> PathBuf {
    let name = source.trim_start_matches("glsl/");
    let variant = if hardware { ".ray_query" } else { "" };
    Path::new("glsl/spirv").join(format!("{name}{variant}.spv"))
}

fn manifest(sources: &BTreeMap<String, String>) -> String {
    sources.iter().fold(String::new(), |mut lines, (path, text)| {
        let hash = Sha256::digest(text.as_bytes()).iter().fold(String::new(), |mut hex, byte| {
            let _ = write!(hex, "{byte:02x}");
            hex
        });
        let _ = writeln!(lines, "{hash}  {path}");
        lines
    })
}

/// Stops the build where the SPIR-V is not that of the GLSL, naming the file.
fn check(sources: &BTreeMap<String, String>) -> Result<()> {
    let committed = fs::read_to_string(MANIFEST).unwrap_or_default().replace("\r\n", "\n");
    let current = manifest(sources);
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let (old, new) = (lines(&committed), lines(&current));
    let changed = new.iter().find(|line| !old.contains(line)).or_else(|| old.iter().find(|line| !new.contains(line)));
    match changed.and_then(|line| line.split_whitespace().nth(1)) {
        Some(file) => Err(format!("glsl/spirv is stale: {file} has changed since; run: {COMMAND}").into()),
        None => Ok(()),
    }
}

/// Writes the table of shaders that `src/gpu/shader.rs` includes.
fn embed(sources: &BTreeMap<String, String>) -> Result<()> {
    let mut table = String::new();
    let of_library = |path: &str| is_stage(path) && !BENCHMARK.contains(&path);
    for (source, text) in sources.iter().filter(|(path, _)| of_library(path)) {
        let name = source.trim_start_matches("glsl/");
        let constant = name.trim_end_matches(".comp").to_uppercase().replace('.', "_");
        let hardware = if TRACING.iter().any(|header| text.contains(header)) {
            format!("Some({})", include(source, true))
        } else {
            "None".into()
        };
        let spirv = include(source, false);
        writeln!(table, "/// `glsl/{name}`.")?;
        writeln!(
            table,
            "pub(crate) static {constant}: Shader = Shader {{ name: {name:?}, spirv: {spirv}, ray_query: {hardware} }};"
        )?;
    }
    fs::write(Path::new(&env::var("OUT_DIR")?).join("shaders.rs"), table)?;
    Ok(())
}

/// Writes the table of shaders that `src/bin/frame_bench/engine/pipeline.rs` includes.
fn embed_benchmark() -> Result<()> {
    let mut table = String::new();
    for source in BENCHMARK {
        let constant = source.trim_start_matches("glsl/").to_uppercase().replace('.', "_");
        writeln!(table, "/// `{source}`.\npub(super) static {constant}: &[u8] = {};", include(source, false))?;
    }
    fs::write(Path::new(&env::var("OUT_DIR")?).join("frame_bench_shaders.rs"), table)?;
    Ok(())
}

/// An expression that is a module's bytes. Relative to wherever the crate is compiled: a build folder may serve more
/// than one clone.
fn include(source: &str, hardware: bool) -> String {
    let path = format!("/{}", module_path(source, hardware).display());
    format!("include_bytes!(concat!(env!(\"CARGO_MANIFEST_DIR\"), {path:?}))")
}

#[cfg(feature = "compile-shaders")]
mod compile {
    use super::{BTreeMap, MANIFEST, Path, PathBuf, Result, TRACING, is_stage, manifest, module_path};
    use shaderc::{CompileOptions, Compiler, EnvVersion, OptimizationLevel, ResolvedInclude, ShaderKind, TargetEnv};
    use std::fs;

    /// Rewrites `glsl/spirv` and its manifest; files whose bytes do not change are left alone.
    pub(super) fn all(sources: &BTreeMap<String, String>) -> Result<()> {
        let compiler = Compiler::new()?;
        let mut kept: Vec<PathBuf> = vec![MANIFEST.into()];
        for (path, text) in sources.iter().filter(|(path, _)| is_stage(path)) {
            for hardware in [false, true] {
                if hardware && !TRACING.iter().any(|header| text.contains(header)) {
                    continue;
                }
                let module = module_path(path, hardware);
                write(&module, &one(&compiler, sources, path, text, hardware)?)?;
                kept.push(module);
            }
        }
        for entry in fs::read_dir("glsl/spirv")? {
            let path = entry?.path();
            if !kept.contains(&path) {
                fs::remove_file(path)?;
            }
        }
        write(Path::new(MANIFEST), manifest(sources).as_bytes())
    }

    fn one(
        compiler: &Compiler,
        sources: &BTreeMap<String, String>,
        path: &str,
        text: &str,
        hardware: bool,
    ) -> Result<Vec<u8>> {
        let kind = match Path::new(path).extension().and_then(|e| e.to_str()) {
            Some("vert") => ShaderKind::Vertex,
            Some("frag") => ShaderKind::Fragment,
            _ => ShaderKind::Compute,
        };
        let mut options = CompileOptions::new()?;
        options.set_target_env(TargetEnv::Vulkan, EnvVersion::Vulkan1_3 as u32);
        // Drivers optimise; names must stay, for the layout test reflects them.
        options.set_optimization_level(OptimizationLevel::Zero);
        options.set_warnings_as_errors();
        if hardware {
            options.add_macro_definition("RAY_QUERY_HARDWARE", None);
        }
        options.set_include_callback(|name, _, _, _| {
            let resolved_name = format!("glsl/include/{}", name.trim_start_matches("include/"));
            let content = sources.get(&resolved_name).ok_or(format!("{resolved_name} does not exist"))?.clone();
            Ok(ResolvedInclude { resolved_name, content })
        });
        let artifact = compiler.compile_into_spirv(text, kind, path, "main", Some(&options))?;
        Ok(artifact.as_binary_u8().to_vec())
    }

    fn write(path: &Path, bytes: &[u8]) -> Result<()> {
        if fs::read(path).ok().as_deref() != Some(bytes) {
            fs::create_dir_all("glsl/spirv")?;
            fs::write(path, bytes)?;
        }
        Ok(())
    }
}
