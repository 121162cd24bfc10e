//! Buffers and images: a description in, a finished object out.

use super::info::TEXEL_BYTES;
use super::objects::{Counted, ObjectKind};
use super::{Gpu, vulkan_error};
use crate::error::{Error, ErrorKind, Result};
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};

/// Who touches the memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Location {
    /// The device alone.
    Device,
    /// The host writes, the device reads.
    Upload,
    /// The device writes, the host reads.
    ReadBack,
}

impl Location {
    fn memory(self) -> MemoryLocation {
        match self {
            Self::Device => MemoryLocation::GpuOnly,
            Self::Upload => MemoryLocation::CpuToGpu,
            Self::ReadBack => MemoryLocation::GpuToCpu,
        }
    }
}

/// What a buffer is for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BufferDesc<'a> {
    pub(crate) name: &'a str,
    /// Bytes; 0 counts as 16, for a binding needs something behind it.
    pub(crate) size: u64,
    pub(crate) usage: vk::BufferUsageFlags,
    pub(crate) location: Location,
}

/// A buffer with its memory.
pub(crate) struct Buffer {
    gpu: Gpu,
    pub(super) handle: vk::Buffer,
    /// Its texels, where its usage says that it is read so.
    pub(super) texels: vk::BufferView,
    allocation: Option<Allocation>,
    size: u64,
    _counted: Counted,
}

impl Buffer {
    /// # Errors
    /// `OutOfMemory`, naming the buffer, its size and the limit.
    pub(crate) fn new(gpu: &Gpu, desc: BufferDesc<'_>) -> Result<Self> {
        let BufferDesc { name, usage, location, .. } = desc;
        let size = desc.size.max(16);
        let limit = gpu.info().max_storage_buffer_bytes;
        if usage.contains(vk::BufferUsageFlags::STORAGE_BUFFER) && size > limit {
            return Err(Error::new(
                ErrorKind::OutOfMemory,
                format!("buffer '{name}' needs {size} bytes; the device allows a storage buffer of {limit}"),
            ));
        }
        let families = gpu.families();
        let mut info = vk::BufferCreateInfo::default().size(size).usage(usage);
        if let Some(families) = &families {
            info = info.sharing_mode(vk::SharingMode::CONCURRENT).queue_family_indices(families);
        }
        // SAFETY: the description is complete.
        let handle = unsafe { gpu.device().create_buffer(&info, None) }
            .map_err(|result| vulkan_error(format!("create buffer '{name}' of {size} bytes"), result))?;
        let mut buffer = Self {
            gpu: gpu.clone(),
            handle,
            texels: vk::BufferView::null(),
            allocation: None,
            size,
            _counted: gpu.count(ObjectKind::Buffer, name),
        };
        // SAFETY: the buffer was just made from this device.
        let requirements = unsafe { gpu.device().get_buffer_memory_requirements(handle) };
        let allocation = allocate(gpu, name, requirements, location.memory(), true)?;
        // SAFETY: the memory fits the buffer's requirements, and nothing else is bound to this part of it.
        let bound = unsafe { gpu.device().bind_buffer_memory(handle, allocation.memory(), allocation.offset()) };
        buffer.allocation = Some(allocation);
        bound.map_err(|result| vulkan_error(format!("bind the memory of buffer '{name}'"), result))?;
        gpu.name(handle, name);
        if usage.contains(vk::BufferUsageFlags::UNIFORM_TEXEL_BUFFER) {
            let format = vk::Format::R32G32B32A32_UINT;
            // A device that allows fewer does not read them: `DeviceInfo::reads_texels`.
            let texels = (size / TEXEL_BYTES).min(gpu.info().max_texel_buffer_elements);
            let range = texels * TEXEL_BYTES;
            let info = vk::BufferViewCreateInfo::default().buffer(handle).format(format).range(range);
            // SAFETY: every device has this format for texel buffers; the buffer has memory, the usage and that size.
            buffer.texels = unsafe { gpu.device().create_buffer_view(&info, None) }
                .map_err(|result| vulkan_error(format!("create the view of buffer '{name}'"), result))?;
        }
        Ok(buffer)
    }

    /// Copies `data` to the start of a buffer that the host writes.
    pub(crate) fn write<T: bytemuck::Pod>(&mut self, data: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let mapped = self.allocation.as_mut().and_then(Allocation::mapped_slice_mut);
        if let Some(target) = mapped.and_then(|slice| slice.get_mut(..bytes.len())) {
            target.copy_from_slice(bytes);
        }
    }

    /// What the device wrote into a buffer that the host reads.
    pub(crate) fn bytes(&self) -> &[u8] {
        let mapped = self.allocation.as_ref().and_then(Allocation::mapped_slice).unwrap_or_default();
        mapped.get(..self.size as usize).unwrap_or(mapped)
    }

    pub(super) fn address(&self) -> vk::DeviceAddress {
        let info = vk::BufferDeviceAddressInfo::default().buffer(self.handle);
        // SAFETY: only called for buffers made with SHADER_DEVICE_ADDRESS, on a device with the feature.
        unsafe { self.gpu.device().get_buffer_device_address(&info) }
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: whoever recorded with it has waited for the device before dropping it.
        unsafe {
            self.gpu.device().destroy_buffer_view(self.texels, None);
            self.gpu.device().destroy_buffer(self.handle, None);
        }
        release(&self.gpu, self.allocation.take());
    }
}

/// What an image is for. All are 2D, with one view of all their mip levels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImageDesc<'a> {
    pub(crate) name: &'a str,
    pub(crate) size: [u32; 2],
    pub(crate) format: vk::Format,
    pub(crate) usage: vk::ImageUsageFlags,
    pub(crate) mip_levels: u32,
}

/// An image with its memory and view. It lives in the layout GENERAL.
pub(crate) struct Image {
    gpu: Gpu,
    pub(super) handle: vk::Image,
    pub(super) view: vk::ImageView,
    allocation: Option<Allocation>,
    pub(super) size: [u32; 2],
    pub(super) mip_levels: u32,
    pub(super) aspect: vk::ImageAspectFlags,
    pub(super) format: vk::Format,
    _counted: Counted,
}

impl Image {
    /// The image is in the layout UNDEFINED until `Recorder::initialise`.
    ///
    /// # Errors
    /// `OutOfMemory`, naming the image and its size; `InvalidSettings` over the device's largest side.
    pub(crate) fn new(gpu: &Gpu, desc: ImageDesc<'_>) -> Result<Self> {
        let ImageDesc { name, size, format, usage, mip_levels } = desc;
        let limit = gpu.info().max_image_side;
        if size[0].max(size[1]) > limit {
            let [width, height] = size;
            return Err(Error::settings(format!(
                "image '{name}' is {width} x {height}; the device allows {limit} a side"
            )));
        }
        let families = gpu.families();
        let mut info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width: size[0], height: size[1], depth: 1 })
            .mip_levels(mip_levels)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(usage);
        if let Some(families) = &families {
            info = info.sharing_mode(vk::SharingMode::CONCURRENT).queue_family_indices(families);
        }
        // SAFETY: the description is complete and within the limits checked above.
        let handle = unsafe { gpu.device().create_image(&info, None) }
            .map_err(|result| vulkan_error(format!("create image '{name}' of {size:?} texels"), result))?;
        let depth = usage.contains(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT);
        let aspect = if depth { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR };
        let mut image = Self {
            gpu: gpu.clone(),
            handle,
            view: vk::ImageView::null(),
            allocation: None,
            size,
            mip_levels,
            aspect,
            format,
            _counted: gpu.count(ObjectKind::Image, name),
        };
        // SAFETY: the image was just made from this device.
        let requirements = unsafe { gpu.device().get_image_memory_requirements(handle) };
        let allocation = allocate(gpu, name, requirements, MemoryLocation::GpuOnly, false)?;
        // SAFETY: the memory fits the image's requirements, and nothing else is bound to this part of it.
        let bound = unsafe { gpu.device().bind_image_memory(handle, allocation.memory(), allocation.offset()) };
        image.allocation = Some(allocation);
        bound.map_err(|result| vulkan_error(format!("bind the memory of image '{name}'"), result))?;
        image.view = image.create_view(name)?;
        gpu.name(handle, name);
        Ok(image)
    }

    /// Width and height of the first mip level.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// For the engine to see.
    pub(crate) fn handles(&self) -> (vk::Image, vk::ImageView) {
        (self.handle, self.view)
    }

    fn create_view(&self, name: &str) -> Result<vk::ImageView> {
        let info = vk::ImageViewCreateInfo::default()
            .image(self.handle)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(self.format)
            .subresource_range(self.range());
        // SAFETY: the image is bound to memory, the view is of its own format and all of it.
        unsafe { self.gpu.device().create_image_view(&info, None) }
            .map_err(|result| vulkan_error(format!("create the view of image '{name}'"), result))
    }

    pub(super) fn range(&self) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange::default().aspect_mask(self.aspect).level_count(self.mip_levels).layer_count(1)
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        // SAFETY: whoever recorded with it has waited for the device before dropping it; a null view is allowed.
        unsafe {
            self.gpu.device().destroy_image_view(self.view, None);
            self.gpu.device().destroy_image(self.handle, None);
        }
        release(&self.gpu, self.allocation.take());
    }
}

fn allocate(
    gpu: &Gpu,
    name: &str,
    requirements: vk::MemoryRequirements,
    location: MemoryLocation,
    linear: bool,
) -> Result<Allocation> {
    let desc = AllocationCreateDesc {
        name,
        requirements,
        location,
        linear,
        allocation_scheme: AllocationScheme::GpuAllocatorManaged,
    };
    gpu.allocator().allocate(&desc).map_err(|error| {
        let size = requirements.size;
        Error::new(ErrorKind::OutOfMemory, format!("allocate {size} bytes for '{name}'")).with_source(error)
    })
}

fn release(gpu: &Gpu, allocation: Option<Allocation>) {
    if let Some(allocation) = allocation
        && let Err(error) = gpu.allocator().free(allocation)
    {
        tracing::error!("free device memory: {error}");
    }
}
