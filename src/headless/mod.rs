//! An instance and a device of our own, for the tools and the tests.

mod kept;

use crate::error::{Error, ErrorKind, Result};
use crate::gpu::{self, BackendChoice, DeviceInfo, Gpu};
use kept::KeptPipelines;
use std::path::PathBuf;

/// What to run on.
#[derive(Debug, Clone, Default)]
pub struct HeadlessSettings {
    /// The device's index, or a part of its name in any case; `None`: the first usable one, GPUs before CPUs.
    pub device: Option<String>,
    /// Which back end is asked for.
    pub backend: BackendChoice,
    /// Whether the validation layers watch.
    pub validation: Validation,
    /// A folder, made where there is none, that keeps compiled pipelines from one run to the next, in a file for each
    /// device, driver and back end. It is read when the device is opened, and written when the [`Headless`] is dropped
    /// and has compiled others. What cannot be read or written is no error. `None`: they are kept nowhere.
    pub pipeline_folder: Option<PathBuf>,
}

/// Whether the validation layers watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Validation {
    /// No layers.
    #[default]
    Off,
    /// `VK_LAYER_KHRONOS_validation` with synchronisation validation; an error where the layer is not installed.
    On,
}

/// A device of our own.
pub struct Headless {
    gpu: Gpu,
    messages: std::sync::Arc<gpu::Messages>,
    kept: Option<KeptPipelines>,
}

impl Headless {
    /// Creates an instance and a device.
    ///
    /// # Errors
    /// `Unsupported` without a Vulkan driver, without a device of that name, or where the device lacks what is asked
    /// for; `InvalidSettings` for a device that does not exist.
    pub fn new(settings: &HeadlessSettings) -> Result<Self> {
        let instance = gpu::create_instance(settings.validation == Validation::On)?;
        let devices = gpu::list_devices(&instance)?;
        let info = choose(&devices, settings.device.as_deref())?;
        if let Err(lack) = &info.usable {
            return Err(Error::new(ErrorKind::Unsupported, format!("device {} '{}' {lack}", info.index, info.name)));
        }
        let backend = gpu::choose_backend(info, settings.backend)?;
        let messages = instance.messages.clone();
        let folder = settings.pipeline_folder.as_ref();
        let kept = folder.map(|folder| KeptPipelines::read(folder, info, backend));
        let bytes = kept.as_ref().map_or(&[][..], |kept| &kept.bytes);
        Ok(Self { gpu: gpu::create_device(instance, info.index, backend, bytes)?, messages, kept })
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// What the validation layers have said so far; empty is as it should be.
    pub fn validation_messages(&self) -> Vec<String> {
        self.messages.all()
    }
}

impl Drop for Headless {
    fn drop(&mut self) {
        if let Some(kept) = &self.kept {
            kept.write(&self.gpu);
        }
    }
}

/// All devices of all drivers.
///
/// # Errors
/// `Unsupported` without a Vulkan driver.
pub fn devices() -> Result<Vec<DeviceInfo>> {
    gpu::list_devices(&gpu::create_instance(false)?)
}

fn choose<'a>(devices: &'a [DeviceInfo], wanted: Option<&str>) -> Result<&'a DeviceInfo> {
    let names = || devices.iter().map(|d| format!("{} '{}'", d.index, d.name)).collect::<Vec<_>>().join(", ");
    let Some(wanted) = wanted else {
        let usable = devices.iter().filter(|device| device.usable.is_ok());
        let lacking = || {
            let lacks = devices.iter().map(|d| format!("'{}' {}", d.name, d.usable.clone().err().unwrap_or_default()));
            let list = lacks.collect::<Vec<_>>().join(", ");
            Error::new(ErrorKind::Unsupported, format!("no usable Vulkan device: {list}"))
        };
        return usable.min_by_key(|device| device.is_cpu()).ok_or_else(lacking);
    };
    if wanted.is_empty() {
        return Err(Error::settings(format!("the device is '', which every name holds; there are: {}", names())));
    }
    let found = match wanted.parse::<usize>() {
        Ok(index) => devices.get(index),
        Err(_) => devices.iter().find(|device| device.name.to_lowercase().contains(&wanted.to_lowercase())),
    };
    found.ok_or_else(|| Error::settings(format!("there is no device '{wanted}'; there are: {}", names())))
}
