//! A foreign engine embeds the baker: frames, changing worlds, time, bad input.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod aiming;
mod bad_input;
mod budget;
mod engine;
mod frames;
mod live;
mod moving;
mod needs;
mod step;
mod still;

#[expect(dead_code, reason = "the physics tests use the rest of it")]
#[path = "../common/stage.rs"]
mod stage;
