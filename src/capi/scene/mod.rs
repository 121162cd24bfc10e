//! Scenes: from arrays, or from glTF.

mod build;
mod desc;
mod info;
mod read;

pub use build::*;
pub use desc::*;
pub use info::*;
pub use read::*;

pub(super) use build::{light, sky};
pub(super) use info::scene_of;
