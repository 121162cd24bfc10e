//! Counts what the library does within frames: host allocations, and the Vulkan calls that wait or make something. The
//! library gets its functions through the engine's get-instance-proc-addr, so the engine can look on.

use ash::vk;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ffi::{CStr, c_char};
use std::sync::atomic::{AtomicPtr, Ordering::Relaxed};

/// Counts of this thread, while it is in a frame's call of the library.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    /// Allocations on the host's heap.
    pub(crate) heap: usize,
    /// Vulkan calls that wait for the device.
    pub(crate) waits: usize,
    /// Vulkan calls that allocate memory or create an object.
    pub(crate) objects: usize,
    /// Drawings, of which a g-buffer would be one.
    pub(crate) draws: usize,
}

thread_local! {
    static IN_FRAME: Cell<bool> = const { Cell::new(false) };
    static COUNTS: Cell<Counts> = const { Cell::new(Counts { heap: 0, waits: 0, objects: 0, draws: 0 }) };
}

/// Counts since the last call.
pub(crate) fn take() -> Counts {
    COUNTS.take()
}

/// A call of the library within a frame.
pub(crate) fn frame<T>(call: impl FnOnce() -> T) -> T {
    IN_FRAME.set(true);
    let result = call();
    IN_FRAME.set(false);
    result
}

fn count(add: impl FnOnce(&mut Counts)) {
    if IN_FRAME.get() {
        let mut counts = COUNTS.get();
        add(&mut counts);
        COUNTS.set(counts);
    }
}

struct CountingAllocator;

// SAFETY: the system's allocator does the work; counting allocates nothing.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(|counts| counts.heap += 1);
        // SAFETY: as the caller has it.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller has it.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(|counts| counts.heap += 1);
        // SAFETY: as the caller has it.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

// Kept anew with every device: layers are unloaded with the last instance, and loaded elsewhere.
static GET_INSTANCE: AtomicPtr<()> = AtomicPtr::new(std::ptr::null_mut());
static GET_DEVICE: AtomicPtr<()> = AtomicPtr::new(std::ptr::null_mut());

/// The loader's, but for what is counted.
pub(crate) fn get_instance_proc_addr(entry: &ash::Entry) -> vk::PFN_vkGetInstanceProcAddr {
    GET_INSTANCE.store(entry.static_fn().get_instance_proc_addr as *mut (), Relaxed);
    instance_function
}

unsafe extern "system" fn instance_function(instance: vk::Instance, name: *const c_char) -> vk::PFN_vkVoidFunction {
    // SAFETY: the loader's own function, called as we are called.
    let function = unsafe {
        std::mem::transmute::<*mut (), vk::PFN_vkGetInstanceProcAddr>(GET_INSTANCE.load(Relaxed))(instance, name)
    };
    // SAFETY: a NUL-terminated name.
    if unsafe { CStr::from_ptr(name) } != c"vkGetDeviceProcAddr" {
        return function;
    }
    GET_DEVICE.store(function.map_or(std::ptr::null_mut(), |function| function as *mut ()), Relaxed);
    let counted: vk::PFN_vkGetDeviceProcAddr = device_function;
    // SAFETY: all functions of Vulkan are handed over as this type.
    unsafe { std::mem::transmute(counted) }
}

/// For each counted function: where the driver's own is kept, and one that counts and calls it.
macro_rules! counted {
    ($($name:literal $module:ident $type:ident $counter:ident ($($argument:ident: $kind:ty),*) -> $result:ty;)+) => {
        $(mod $module {
            use super::*;
            pub(super) static ORIGINAL: AtomicPtr<()> = AtomicPtr::new(std::ptr::null_mut());
            pub(super) unsafe extern "system" fn counted($($argument: $kind),*) -> $result {
                count(|counts| counts.$counter += 1);
                // SAFETY: the driver's own function, called as we are called.
                unsafe { std::mem::transmute::<*mut (), vk::$type>(ORIGINAL.load(Relaxed))($($argument),*) }
            }
        })+

        unsafe extern "system" fn device_function(device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
            // SAFETY: the loader's own function, called as we are called.
            let function = unsafe {
                std::mem::transmute::<*mut (), vk::PFN_vkGetDeviceProcAddr>(GET_DEVICE.load(Relaxed))(device, name)
            };
            // SAFETY: a NUL-terminated name.
            let name = unsafe { CStr::from_ptr(name) };
            $(if let Some(original) = function.filter(|_| name == $name) {
                $module::ORIGINAL.store(original as *mut (), Relaxed);
                // SAFETY: all functions of Vulkan are handed over as this type.
                return unsafe { std::mem::transmute::<*const (), vk::PFN_vkVoidFunction>($module::counted as *const ()) };
            })+
            function
        }
    };
}

type Allocator = vk::AllocationCallbacks<'static>;

counted! {
    c"vkDeviceWaitIdle" device_wait PFN_vkDeviceWaitIdle waits (device: vk::Device) -> vk::Result;
    c"vkQueueWaitIdle" queue_wait PFN_vkQueueWaitIdle waits (queue: vk::Queue) -> vk::Result;
    c"vkWaitForFences" fence_wait PFN_vkWaitForFences waits
        (device: vk::Device, count: u32, fences: *const vk::Fence, all: vk::Bool32, timeout: u64) -> vk::Result;
    c"vkWaitSemaphores" semaphore_wait PFN_vkWaitSemaphores waits
        (device: vk::Device, info: *const vk::SemaphoreWaitInfo<'_>, timeout: u64) -> vk::Result;
    c"vkCmdBeginRendering" draw PFN_vkCmdBeginRendering draws
        (commands: vk::CommandBuffer, info: *const vk::RenderingInfo<'_>) -> ();
    c"vkAllocateMemory" memory PFN_vkAllocateMemory objects
        (device: vk::Device, info: *const vk::MemoryAllocateInfo<'_>, a: *const Allocator, out: *mut vk::DeviceMemory) -> vk::Result;
    c"vkCreateBuffer" buffer PFN_vkCreateBuffer objects
        (device: vk::Device, info: *const vk::BufferCreateInfo<'_>, a: *const Allocator, out: *mut vk::Buffer) -> vk::Result;
    c"vkCreateImage" image PFN_vkCreateImage objects
        (device: vk::Device, info: *const vk::ImageCreateInfo<'_>, a: *const Allocator, out: *mut vk::Image) -> vk::Result;
    c"vkCreateDescriptorPool" descriptors PFN_vkCreateDescriptorPool objects
        (device: vk::Device, info: *const vk::DescriptorPoolCreateInfo<'_>, a: *const Allocator, out: *mut vk::DescriptorPool) -> vk::Result;
    c"vkCreateImageView" view PFN_vkCreateImageView objects
        (device: vk::Device, info: *const vk::ImageViewCreateInfo<'_>, a: *const Allocator, out: *mut vk::ImageView) -> vk::Result;
    c"vkCreateCommandPool" command_pool PFN_vkCreateCommandPool objects
        (device: vk::Device, info: *const vk::CommandPoolCreateInfo<'_>, a: *const Allocator, out: *mut vk::CommandPool) -> vk::Result;
    c"vkCreateQueryPool" query_pool PFN_vkCreateQueryPool objects
        (device: vk::Device, info: *const vk::QueryPoolCreateInfo<'_>, a: *const Allocator, out: *mut vk::QueryPool) -> vk::Result;
    c"vkCreateFence" fence PFN_vkCreateFence objects
        (device: vk::Device, info: *const vk::FenceCreateInfo<'_>, a: *const Allocator, out: *mut vk::Fence) -> vk::Result;
    c"vkCreateSemaphore" semaphore PFN_vkCreateSemaphore objects
        (device: vk::Device, info: *const vk::SemaphoreCreateInfo<'_>, a: *const Allocator, out: *mut vk::Semaphore) -> vk::Result;
    c"vkCreateSampler" sampler PFN_vkCreateSampler objects
        (device: vk::Device, info: *const vk::SamplerCreateInfo<'_>, a: *const Allocator, out: *mut vk::Sampler) -> vk::Result;
    c"vkCreateShaderModule" module PFN_vkCreateShaderModule objects
        (device: vk::Device, info: *const vk::ShaderModuleCreateInfo<'_>, a: *const Allocator, out: *mut vk::ShaderModule) -> vk::Result;
    c"vkCreatePipelineLayout" pipeline_layout PFN_vkCreatePipelineLayout objects
        (device: vk::Device, info: *const vk::PipelineLayoutCreateInfo<'_>, a: *const Allocator, out: *mut vk::PipelineLayout) -> vk::Result;
    c"vkCreateAccelerationStructureKHR" structure PFN_vkCreateAccelerationStructureKHR objects
        (device: vk::Device, info: *const vk::AccelerationStructureCreateInfoKHR<'_>, a: *const Allocator, out: *mut vk::AccelerationStructureKHR) -> vk::Result;
    c"vkAllocateDescriptorSets" sets PFN_vkAllocateDescriptorSets objects
        (device: vk::Device, info: *const vk::DescriptorSetAllocateInfo<'_>, out: *mut vk::DescriptorSet) -> vk::Result;
    c"vkAllocateCommandBuffers" commands PFN_vkAllocateCommandBuffers objects
        (device: vk::Device, info: *const vk::CommandBufferAllocateInfo<'_>, out: *mut vk::CommandBuffer) -> vk::Result;
}
