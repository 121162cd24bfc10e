//! Compiled pipelines that stay in a folder between runs.

use crate::error::{Error, Result};
use crate::gpu::{Backend, DeviceInfo, Gpu};
use crate::io::write_beside;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// A file that is larger is not read: all of the pipelines are some megabytes.
const MOST_BYTES: u64 = 1 << 28;

/// A device's file in the folder. What cannot be read or written costs time only, and so is no error.
pub(super) struct KeptPipelines {
    path: PathBuf,
    /// What it held.
    pub(super) bytes: Vec<u8>,
}

impl KeptPipelines {
    pub(super) fn read(folder: &Path, info: &DeviceInfo, backend: Backend) -> Self {
        let path = folder.join(file_name(info, backend));
        let bytes = read_file(&path).unwrap_or_else(|error| {
            tracing::debug!("cannot read '{}': {error}", path.display());
            Vec::new()
        });
        Self { path, bytes }
    }

    /// Where there is something new.
    pub(super) fn write(&self, gpu: &Gpu) {
        let written =
            gpu.pipeline_cache().and_then(|bytes| if bytes == self.bytes { Ok(()) } else { self.put(&bytes) });
        if let Err(error) = written {
            tracing::debug!("the compiled pipelines are not kept: {error}");
        }
    }

    fn put(&self, bytes: &[u8]) -> Result<()> {
        if let Some(folder) = self.path.parent() {
            // Where this fails the next line says so.
            let _ = fs::create_dir_all(folder);
        }
        let context = || format!("cannot write '{}'", self.path.display());
        write_beside(&self.path, |file| file.write_all(bytes).map_err(|error| Error::io(context(), error)))
    }
}

/// A file that is none, a pipe for instance, might never end.
fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() || metadata.len() > MOST_BYTES {
        let text = format!("it is no file of at most {MOST_BYTES} bytes");
        return Err(io::Error::new(io::ErrorKind::InvalidData, text));
    }
    fs::read(path)
}

/// The device, its driver and the back end.
fn file_name(info: &DeviceInfo, backend: Backend) -> String {
    let driver = info.pipeline_cache_uuid.iter().fold(String::new(), |mut hex, byte| {
        // Writing to a string cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    });
    format!("{:04x}-{:04x}-{driver}-{}.pipelines", info.vendor_id, info.device_id, backend.name())
}
