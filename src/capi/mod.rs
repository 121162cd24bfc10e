//! The C interface, `lightoven.h`: handles, structures and functions over [`crate::baker::Baker`].
//!
//! - Handles are numbers that are never used twice: a call with one that was destroyed is refused.
//! - Every structure begins with its size, which the caller sets, so that members can be added at its end.
//! - Every call gives a [`LightovenStatus`]; [`lightoven_last_error`] has the text to it, for each thread its own.
//! - No panic leaves a call. Callbacks of the engine do not unwind either.
//!
//! What each function asks of its pointers is said there. Where nothing is said a pointer is not NULL.
#![expect(unsafe_code, reason = "pointers and handles come from C")]

mod arguments;
mod atlas;
mod baker;
mod changes;
mod frames;
mod gpu;
mod handles;
mod log;
mod scene;
mod settings;
mod statistics;
mod status;
mod still;
mod version;
mod vulkan;

pub use atlas::*;
pub use baker::*;
pub use changes::*;
pub use frames::*;
pub use gpu::*;
pub use log::*;
pub use scene::*;
pub use settings::*;
pub use statistics::*;
pub use status::*;
pub use still::*;
pub use version::*;
