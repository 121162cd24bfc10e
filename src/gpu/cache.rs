//! Compiled pipelines as bytes that outlive the process. A driver trusts what it is handed, so bytes are looked at first.

use super::info::DeviceInfo;
use super::{Gpu, vulkan_error};
use crate::error::Result;
use ash::vk;

/// What our bytes begin with.
const MAGIC: [u8; 8] = *b"LOVPIPES";
/// Of our own header, in little-endian order: magic, version, length of what follows it, its checksum.
const VERSION: u32 = 1;
const HEADER: usize = 28;
/// Of `VkPipelineCacheHeaderVersionOne`.
const DRIVER_HEADER: usize = 32;

/// What all pipelines of a device are made with.
pub(super) struct PipelineCache {
    device: ash::Device,
    handle: vk::PipelineCache,
}

impl PipelineCache {
    /// With what is in `bytes`; what is not of this device and driver, or damaged, is left aside.
    pub(super) fn new(device: &ash::Device, info: &DeviceInfo, bytes: &[u8]) -> Result<Self> {
        let initial = unwrap(bytes, info).unwrap_or_else(|why| {
            tracing::warn!("the pipeline cache is left aside, and pipelines are compiled anew: {why}");
            &[]
        });
        let create = |initial: &[u8]| {
            let info = vk::PipelineCacheCreateInfo::default().initial_data(initial);
            // SAFETY: the bytes are none, or as this very driver gave them.
            unsafe { device.create_pipeline_cache(&info, None) }
        };
        let handle = create(initial)
            .or_else(|_| create(&[]))
            .map_err(|result| vulkan_error("create the pipeline cache", result))?;
        Ok(Self { device: device.clone(), handle })
    }
}

impl Drop for PipelineCache {
    fn drop(&mut self) {
        // SAFETY: nobody makes a pipeline with it any more: who did held the Gpu that it goes with.
        unsafe { self.device.destroy_pipeline_cache(self.handle, None) };
    }
}

impl Gpu {
    /// For making pipelines with.
    pub(super) fn pipelines_kept(&self) -> vk::PipelineCache {
        self.inner.pipeline_cache.handle
    }

    /// The compiled pipelines of this `Gpu`: those that it was given and those made since, alive or not. Bytes for
    /// [`super::RawDevice::pipeline_cache`] or a file; some megabytes, or on drivers that keep compiled shaders elsewhere
    /// a few bytes. They are of use to the same device with the same driver only, and left aside by others.
    ///
    /// # Errors
    /// `OutOfMemory`, of the host or the device.
    pub fn pipeline_cache(&self) -> Result<Vec<u8>> {
        // SAFETY: the cache is the device's and alive; drivers lock it themselves.
        let data = unsafe { self.device().get_pipeline_cache_data(self.pipelines_kept()) }
            .map_err(|result| vulkan_error("read the pipeline cache", result))?;
        Ok(wrap(&data))
    }
}

/// The driver's bytes behind our own header.
fn wrap(data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + data.len());
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((data.len() as u64).to_le_bytes());
    bytes.extend(checksum(data).to_le_bytes());
    bytes.extend(data);
    bytes
}

/// The driver's bytes, where they are whole and of this device and driver, or none where there are none; else why not.
fn unwrap<'a>(bytes: &'a [u8], info: &DeviceInfo) -> Result<&'a [u8], String> {
    if bytes.is_empty() {
        return Ok(bytes);
    }
    let short = || format!("{} bytes are too few", bytes.len());
    let (header, data) = bytes.split_at_checked(HEADER).ok_or_else(short)?;
    if header[..8] != MAGIC {
        return Err("it does not begin as one of ours".into());
    }
    if word(header, 8) != VERSION {
        return Err(format!("its version is {}; known is {VERSION}", word(header, 8)));
    }
    if header[12..20] != (data.len() as u64).to_le_bytes() {
        return Err(format!("it is cut short or too long, with {} bytes after its header", data.len()));
    }
    if header[20..] != checksum(data).to_le_bytes() {
        return Err("it is damaged: the checksum differs".into());
    }
    check_driver(data, info).map(|()| data)
}

/// Whether the driver's own header, `VkPipelineCacheHeaderVersionOne`, is that of this device and driver.
fn check_driver(data: &[u8], info: &DeviceInfo) -> Result<(), String> {
    if data.len() < DRIVER_HEADER || (word(data, 0) as usize) < DRIVER_HEADER || word(data, 0) as usize > data.len() {
        return Err(format!("the driver's part of {} bytes has no whole header", data.len()));
    }
    if word(data, 4) != vk::PipelineCacheHeaderVersion::ONE.as_raw() as u32 {
        return Err(format!("the driver's header has version {}; known is 1", word(data, 4)));
    }
    let of = [word(data, 8), word(data, 12)];
    if of != [info.vendor_id, info.device_id] {
        let [vendor, device] = of;
        let [our_vendor, our_device] = [info.vendor_id, info.device_id];
        return Err(format!(
            "it is of the device {vendor:04x}:{device:04x}, and this is {our_vendor:04x}:{our_device:04x}"
        ));
    }
    if data[16..DRIVER_HEADER] != info.pipeline_cache_uuid {
        return Err("it is of another driver, or another version of it".into());
    }
    Ok(())
}

/// Least significant byte first, which the specification wants of drivers too, whatever the host.
fn word(bytes: &[u8], at: usize) -> u32 {
    let word = bytes.get(at..at + 4).and_then(|word| word.try_into().ok());
    word.map_or(0, u32::from_le_bytes)
}

/// FNV-1a with 64 bits (Fowler, Noll and Vo): finds damage, not malice.
fn checksum(data: &[u8]) -> u64 {
    data.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::{DRIVER_HEADER, HEADER, checksum, unwrap, wrap};
    use crate::gpu::DeviceInfo;

    fn info() -> DeviceInfo {
        DeviceInfo {
            index: 0,
            name: String::new(),
            driver: String::new(),
            api_version: (1, 3, 0),
            kind: "CPU",
            ray_query: false,
            usable: Ok(()),
            vendor_id: 0x1000_5000,
            device_id: 7,
            pipeline_cache_uuid: [9; 16],
            max_storage_buffer_bytes: 0,
            max_texel_buffer_elements: 0,
            max_image_side: 0,
            device_memory_bytes: 0,
        }
    }

    /// A driver's bytes: its header, and three more.
    fn data(header: [u32; 4], uuid: [u8; 16]) -> Vec<u8> {
        let mut data = header.map(u32::to_le_bytes).concat();
        data.extend(uuid);
        data.extend([1, 2, 3]);
        data
    }

    fn ours() -> Vec<u8> {
        data([32, 1, 0x1000_5000, 7], [9; 16])
    }

    #[test]
    fn bytes_come_back() {
        assert_eq!(unwrap(&wrap(&ours()), &info()), Ok(&*ours()));
        assert_eq!(unwrap(&[], &info()), Ok(&[][..]));
    }

    #[test]
    fn the_checksum_is_that_of_the_paper() {
        assert_eq!([checksum(b""), checksum(b"a")], [0xcbf2_9ce4_8422_2325, 0xaf63_dc4c_8601_ec8c]);
    }

    #[test]
    fn any_damage_is_seen() {
        let whole = wrap(&ours());
        for length in 1..whole.len() {
            assert!(unwrap(&whole[..length], &info()).is_err(), "{length} bytes");
        }
        for place in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[place] ^= 0x10;
            assert!(unwrap(&damaged, &info()).is_err(), "byte {place}");
        }
        assert!(unwrap(&[whole, vec![0]].concat(), &info()).is_err());
    }

    #[test]
    fn what_is_of_another_device_is_not_taken() {
        let why = |data: &[u8]| unwrap(&wrap(data), &info()).expect_err("is refused");
        assert!(why(&data([32, 1, 0x10de, 7], [9; 16])).contains("device 10de:0007"));
        assert!(why(&data([32, 1, 0x1000_5000, 8], [9; 16])).contains("10005000:0008"));
        assert!(why(&data([32, 1, 0x1000_5000, 7], [8; 16])).contains("another driver"));
        assert!(why(&data([32, 2, 0x1000_5000, 7], [9; 16])).contains("version 2"));
        for length in [0, 31, 36] {
            assert!(why(&data([length, 1, 0x1000_5000, 7], [9; 16])).contains("header"), "{length}");
        }
        assert!(why(&ours()[..DRIVER_HEADER - 1]).contains("header"));
        assert!(why(&[]).contains("header"));
        assert_eq!(wrap(&[]).len(), HEADER);
    }
}
