//! The one error type of the crate.

use std::borrow::Cow;
use std::fmt;

/// What class of failure an [`Error`] is; callers branch on this.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The device, driver or file lacks something that was asked for.
    Unsupported,
    /// Host or device memory ran out, or a buffer is over the device's limit.
    OutOfMemory,
    /// The device was lost; everything on it is gone.
    DeviceLost,
    /// The scene cannot be baked as it is.
    InvalidScene,
    /// A setting is outside what is allowed.
    InvalidSettings,
    /// A file could not be read or written.
    Io,
    /// The driver failed in a way that none of the others describe.
    Driver,
}

/// A failure: its kind, what was being done and with what, and what caused it.
#[derive(Debug)]
pub struct Error {
    kind: ErrorKind,
    context: Cow<'static, str>,
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

/// The crate's result type.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// An error without an underlying cause. `context` names the thing, its value and what is allowed.
    pub fn new(kind: ErrorKind, context: impl Into<Cow<'static, str>>) -> Self {
        Self { kind, context: context.into(), source: None }
    }

    /// The same error with the cause that lies under it.
    #[must_use]
    pub fn with_source(mut self, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        self.source = Some(source.into());
        self
    }

    /// What class of failure this is.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// What was being done, and with what.
    pub fn context(&self) -> &str {
        &self.context
    }

    pub(crate) fn scene(context: impl Into<Cow<'static, str>>) -> Self {
        Self::new(ErrorKind::InvalidScene, context)
    }

    pub(crate) fn settings(context: impl Into<Cow<'static, str>>) -> Self {
        Self::new(ErrorKind::InvalidSettings, context)
    }

    pub(crate) fn io(context: impl Into<Cow<'static, str>>, source: std::io::Error) -> Self {
        Self::new(ErrorKind::Io, context).with_source(source)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.context)?;
        match &self.source {
            Some(source) => write!(f, ": {source}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.source.as_deref().map(|source| source as _)
    }
}
