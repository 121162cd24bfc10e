//! The C interface: its header, engines in C and C++ that use it, and calls that are wrong.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../embed/engine/mod.rs"]
#[expect(dead_code, reason = "an engine that draws and counts, for tests/embed")]
mod engine;
mod engines;
mod header;
mod installed;
mod library;
mod misuse;
mod place;
mod reference;
