//! The device as the command line asks for it.

use crate::arguments::DeviceArguments;
use lightoven::gpu::BackendChoice;
use lightoven::headless::{Headless, HeadlessSettings, Validation};
use lightoven::{Error, ErrorKind, Result};
use std::env;
use std::path::PathBuf;

/// Opens it, watched by the validation layer where `LIGHTOVEN_VALIDATION` is 1.
pub(crate) fn open(arguments: &DeviceArguments) -> Result<Headless> {
    open_with(arguments, arguments.backend())
}

/// The same with a back end of the tool's choice.
pub(crate) fn open_with(arguments: &DeviceArguments, backend: BackendChoice) -> Result<Headless> {
    let wanted = env::var_os("LIGHTOVEN_VALIDATION").is_some_and(|value| value == "1");
    let settings = arguments.settings(if wanted { Validation::On } else { Validation::Off });
    Headless::new(&HeadlessSettings { backend, pipeline_folder: pipeline_folder(), ..settings })
}

/// In the user's own folder for what can be made anew; `None` where the system names none, or `LIGHTOVEN_PIPELINE_CACHE`
/// is 0.
fn pipeline_folder() -> Option<PathBuf> {
    if env::var_os("LIGHTOVEN_PIPELINE_CACHE").is_some_and(|value| value == "0") {
        return None;
    }
    // By the XDG Base Directory Specification relative paths do not count.
    let folder = |name| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let caches = folder("XDG_CACHE_HOME").or_else(|| Some(folder("HOME")?.join(".cache")))?;
    Some(caches.join("lightoven"))
}

/// A bake that broke Vulkan's rules proves nothing, whatever its light map looks like.
pub(crate) fn fail_on_validation(headless: &Headless) -> Result<()> {
    match &headless.validation_messages()[..] {
        [] => Ok(()),
        [first, rest @ ..] => {
            let context = format!("the validation layer has {} messages, the first: {first}", rest.len() + 1);
            Err(Error::new(ErrorKind::Driver, context))
        }
    }
}
