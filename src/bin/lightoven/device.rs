//! The device as the command line asks for it.

use crate::arguments::DeviceArguments;
use lightoven::gpu::BackendChoice;
use lightoven::headless::{Headless, HeadlessSettings, Validation};
use lightoven::{Error, ErrorKind, Result};

/// Opens it, watched by the validation layer where `LIGHTOVEN_VALIDATION` is 1.
pub(crate) fn open(arguments: &DeviceArguments) -> Result<Headless> {
    open_with(arguments, arguments.backend())
}

/// The same with a back end of the tool's choice.
pub(crate) fn open_with(arguments: &DeviceArguments, backend: BackendChoice) -> Result<Headless> {
    let wanted = std::env::var_os("LIGHTOVEN_VALIDATION").is_some_and(|value| value == "1");
    let settings = arguments.settings(if wanted { Validation::On } else { Validation::Off });
    Headless::new(&HeadlessSettings { backend, ..settings })
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
