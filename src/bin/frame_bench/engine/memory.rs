//! Buffers and images, each with memory of its own: there are a dozen of them.

use super::{Device, failed};
use ash::vk;
use lightoven::{Error, ErrorKind, Result};
use std::rc::Rc;

/// Where memory lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Location {
    Device,
    /// Mapped, and coherent with the device.
    Host,
}

impl Location {
    fn flags(self) -> vk::MemoryPropertyFlags {
        match self {
            Self::Device => vk::MemoryPropertyFlags::DEVICE_LOCAL,
            Self::Host => vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT,
        }
    }
}

/// Memory, freed when it is dropped.
struct Memory {
    device: Rc<Device>,
    handle: vk::DeviceMemory,
}

impl Memory {
    fn new(device: &Rc<Device>, name: &str, needs: vk::MemoryRequirements, location: Location) -> Result<Self> {
        let types = device.memory.memory_types_as_slice().iter().enumerate();
        let fits = |index: usize, flags: vk::MemoryPropertyFlags| {
            needs.memory_type_bits & (1 << index) != 0 && flags.contains(location.flags())
        };
        let found =
            types.clone().find(|(index, kind)| fits(*index, kind.property_flags)).map(|(index, _)| index as u32);
        let index = found
            .ok_or_else(|| Error::new(ErrorKind::Unsupported, format!("no memory of the device suits '{name}'")))?;
        let info = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(index);
        // SAFETY: the type is one of the device's.
        let handle = unsafe { device.functions.allocate_memory(&info, None) }
            .map_err(failed(format!("allocate {} bytes for '{name}'", needs.size)))?;
        Ok(Self { device: device.clone(), handle })
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        // SAFETY: the buffer or image in it went before it (field order), and the device is done with it: every frame
        // is waited for.
        unsafe { self.device.functions.free_memory(self.handle, None) };
    }
}

/// A buffer.
pub(super) struct Buffer {
    handle: BufferHandle,
    memory: Memory,
    pub(super) size: u64,
}

struct BufferHandle(Rc<Device>, vk::Buffer);

impl Drop for BufferHandle {
    fn drop(&mut self) {
        // SAFETY: every frame is waited for, so the device is done with it.
        unsafe { self.0.functions.destroy_buffer(self.1, None) };
    }
}

impl Buffer {
    /// Of at least one byte.
    pub(super) fn new(
        device: &Rc<Device>,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        location: Location,
    ) -> Result<Self> {
        let size = size.max(16);
        if usage.contains(vk::BufferUsageFlags::STORAGE_BUFFER)
            && size > u64::from(device.limits.max_storage_buffer_range)
        {
            let most = device.limits.max_storage_buffer_range;
            let context = format!("buffer '{name}' would have {size} bytes; the device allows {most}");
            return Err(Error::new(ErrorKind::OutOfMemory, context));
        }
        let info = vk::BufferCreateInfo::default().size(size).usage(usage);
        // SAFETY: the description is complete.
        let handle = unsafe { device.functions.create_buffer(&info, None) }
            .map_err(failed(format!("create buffer '{name}'")))?;
        let handle = BufferHandle(device.clone(), handle);
        // SAFETY: the buffer was just made from this device.
        let needs = unsafe { device.functions.get_buffer_memory_requirements(handle.1) };
        let memory = Memory::new(device, name, needs, location)?;
        // SAFETY: the memory fits the buffer's requirements and holds nothing else.
        unsafe { device.functions.bind_buffer_memory(handle.1, memory.handle, 0) }
            .map_err(failed(format!("bind the memory of buffer '{name}'")))?;
        Ok(Self { handle, memory, size })
    }

    /// A host buffer that holds `bytes`.
    pub(super) fn holding(device: &Rc<Device>, name: &str, bytes: &[u8], usage: vk::BufferUsageFlags) -> Result<Self> {
        let buffer = Self::new(device, name, bytes.len() as u64, usage, Location::Host)?;
        buffer.access(|contents| contents[..bytes.len()].copy_from_slice(bytes))?;
        Ok(buffer)
    }

    pub(super) fn handle(&self) -> vk::Buffer {
        self.handle.1
    }

    /// Lets the host read and write a host buffer that no frame under way uses.
    pub(super) fn access<T>(&self, access: impl FnOnce(&mut [u8]) -> T) -> Result<T> {
        let device = &self.memory.device.functions;
        // SAFETY: the memory is host visible, `Location::Host`, and mapped by nobody else: this maps and unmaps.
        let start = unsafe { device.map_memory(self.memory.handle, 0, self.size, vk::MemoryMapFlags::empty()) }
            .map_err(failed("map a buffer"))?;
        // SAFETY: `size` bytes are mapped there until the unmapping below, and nothing else refers to them.
        let result = access(unsafe { std::slice::from_raw_parts_mut(start.cast::<u8>(), self.size as usize) });
        // SAFETY: it was mapped above.
        unsafe { device.unmap_memory(self.memory.handle) };
        Ok(result)
    }
}

/// What an image is for.
#[derive(Debug, Clone, Copy)]
pub(super) struct ImageDesc<'a> {
    pub(super) name: &'a str,
    pub(super) size: [u32; 2],
    pub(super) format: vk::Format,
    pub(super) aspect: vk::ImageAspectFlags,
    pub(super) usage: vk::ImageUsageFlags,
}

/// A device-local image and its view.
pub(super) struct Image {
    handles: ImageHandles,
    _memory: Memory,
    pub(super) size: [u32; 2],
    aspect: vk::ImageAspectFlags,
}

struct ImageHandles(Rc<Device>, vk::Image, vk::ImageView);

impl Drop for ImageHandles {
    fn drop(&mut self) {
        // SAFETY: every frame is waited for, so the device is done with them; a null view is allowed.
        unsafe {
            self.0.functions.destroy_image_view(self.2, None);
            self.0.functions.destroy_image(self.1, None);
        }
    }
}

impl Image {
    pub(super) fn new(device: &Rc<Device>, desc: &ImageDesc<'_>) -> Result<Self> {
        let ImageDesc { name, size, format, aspect, usage } = *desc;
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width: size[0], height: size[1], depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        // SAFETY: the description is complete; sizes are within the device's limit (values.rs), formats are common.
        let handle =
            unsafe { device.functions.create_image(&info, None) }.map_err(failed(format!("create image '{name}'")))?;
        let mut handles = ImageHandles(device.clone(), handle, vk::ImageView::null());
        // SAFETY: the image was just made from this device.
        let needs = unsafe { device.functions.get_image_memory_requirements(handle) };
        let memory = Memory::new(device, name, needs, Location::Device)?;
        // SAFETY: the memory fits the image's requirements and holds nothing else.
        unsafe { device.functions.bind_image_memory(handle, memory.handle, 0) }
            .map_err(failed(format!("bind the memory of image '{name}'")))?;
        let info = vk::ImageViewCreateInfo::default()
            .image(handle)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format)
            .subresource_range(whole(aspect));
        // SAFETY: the image is bound to memory, the view is of its own format and all of it.
        handles.2 = unsafe { device.functions.create_image_view(&info, None) }
            .map_err(failed(format!("create the view of image '{name}'")))?;
        Ok(Self { handles, _memory: memory, size, aspect })
    }

    pub(super) fn handle(&self) -> vk::Image {
        self.handles.1
    }

    pub(super) fn view(&self) -> vk::ImageView {
        self.handles.2
    }

    pub(super) fn range(&self) -> vk::ImageSubresourceRange {
        whole(self.aspect)
    }
}

fn whole(aspect: vk::ImageAspectFlags) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange::default().aspect_mask(aspect).level_count(1).layer_count(1)
}
