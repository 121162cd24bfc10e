//! Embeds the compiled shaders.
fn main() {}
