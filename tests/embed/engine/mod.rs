//! A foreign engine: an instance and a device of its own, watched by the validation layers, frames of one command buffer.
#![expect(unsafe_code, reason = "an engine calls Vulkan itself")]

pub(crate) mod counting;
pub(crate) mod draw;
mod in_flight;

use ash::{ext, vk};
use draw::Draw;
use lightoven::baker::{Baker, FrameReport, FrameTiming};
use lightoven::gpu::{
    BackendChoice, FeatureChain, FrameCommands, Gpu, RawDevice, RawQueue, Requirements, TimelinePoint,
};
use std::ffi::{CStr, c_void};
use std::sync::Mutex;
use std::time::Duration;

/// An engine. Its fields are taken apart in [`Engine::finish`].
pub(crate) struct Engine {
    entry: ash::Entry,
    instance: ash::Instance,
    messenger: vk::DebugUtilsMessengerEXT,
    messages: Box<Mutex<Vec<String>>>,
    pub(crate) device: ash::Device,
    physical_device: vk::PhysicalDevice,
    queue: RawQueue,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    timeline: vk::Semaphore,
    reached: u64,
    gpu: Option<Gpu>,
    requirements: Requirements,
}

unsafe extern "system" fn receive(
    _: vk::DebugUtilsMessageSeverityFlagsEXT,
    _: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: Vulkan hands over a valid structure and the pointer that `Engine::new` gave it.
    let (data, messages) = unsafe { (&*data, &*messages.cast::<Mutex<Vec<String>>>()) };
    // SAFETY: a NUL-terminated text, or null.
    let text = unsafe { data.message_as_c_str() }.map_or_else(String::new, |text| text.to_string_lossy().into_owned());
    messages.lock().unwrap().push(text);
    vk::FALSE
}

const INSTANCE_EXTENSIONS: [&CStr; 1] = [ext::debug_utils::NAME];

impl Engine {
    /// `None`: the device has no such back end, and nobody insists on it.
    pub(crate) fn new(backend: BackendChoice) -> Option<Self> {
        // SAFETY: plain Vulkan, as its specification has it; handles are those that were just made.
        unsafe {
            let entry = ash::Entry::load().expect("there is a Vulkan loader");
            let (instance, messenger, messages) = create_instance(&entry);
            let physical_device = instance.enumerate_physical_devices().unwrap()[0];
            let get = counting::get_instance_proc_addr(&entry);
            let requirements = match Gpu::requirements(get, instance.handle(), physical_device, backend) {
                Ok(requirements) => requirements,
                Err(error) => {
                    skip_or_fail(backend, &error);
                    ext::debug_utils::Instance::new(&entry, &instance).destroy_debug_utils_messenger(messenger, None);
                    instance.destroy_instance(None);
                    return None;
                }
            };
            let families = instance.get_physical_device_queue_family_properties(physical_device);
            let wanted = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
            let family = families.iter().position(|family| family.queue_flags.contains(wanted)).unwrap() as u32;
            let priorities = [1.0];
            let queues =
                [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&priorities)];
            let extensions: Vec<_> = requirements.device_extensions.iter().map(|name| name.as_ptr()).collect();
            let mut features = FeatureChain::new(requirements.features);
            let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&extensions);
            let device = instance.create_device(physical_device, &features.attach(info), None).unwrap();
            let queue = RawQueue { handle: device.get_device_queue(family, 0), family };
            let pool = device
                .create_command_pool(
                    &vk::CommandPoolCreateInfo::default()
                        .queue_family_index(family)
                        .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER),
                    None,
                )
                .unwrap();
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = device.allocate_command_buffers(&info).unwrap()[0];
            let fence = device.create_fence(&vk::FenceCreateInfo::default(), None).unwrap();
            let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
            let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
            let timeline = device.create_semaphore(&info, None).unwrap();
            let mut engine = Self {
                entry,
                instance,
                messenger,
                messages,
                device,
                physical_device,
                queue,
                pool,
                commands,
                fence,
                timeline,
                reached: 0,
                gpu: None,
                requirements,
            };
            engine.gpu = Some(Gpu::from_raw(engine.raw(backend)).expect("all that is required was enabled"));
            Some(engine)
        }
    }

    pub(crate) fn raw(&self, backend: BackendChoice) -> RawDevice<'_> {
        RawDevice {
            get_instance_proc_addr: counting::get_instance_proc_addr(&self.entry),
            instance: self.instance.handle(),
            physical_device: self.physical_device,
            device: self.device.handle(),
            queue: self.queue,
            compute_queue: None,
            instance_extensions: &INSTANCE_EXTENSIONS,
            device_extensions: &self.requirements.device_extensions,
            features: self.requirements.features,
            backend,
            pipeline_cache: &[],
        }
    }

    /// The message that a device without something gives.
    pub(crate) fn refused(&self, raw: RawDevice<'_>) -> String {
        // SAFETY: handles are valid; what is said to be enabled is less than what is.
        unsafe { Gpu::from_raw(raw) }.err().expect("is refused").to_string()
    }

    /// The same device once more.
    pub(crate) fn again(&self, raw: RawDevice<'_>) -> Gpu {
        // SAFETY: handles are valid and as `raw` gave them; the callers drop it before the engine.
        unsafe { Gpu::from_raw(raw) }.expect("is taken")
    }

    pub(crate) fn gpu(&self) -> &Gpu {
        self.gpu.as_ref().unwrap()
    }

    fn begin(&self) {
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the last frame was waited for.
        unsafe {
            self.device.reset_command_buffer(self.commands, vk::CommandBufferResetFlags::empty()).unwrap();
            self.device.begin_command_buffer(self.commands, &begin).unwrap();
        }
    }

    fn end(&self, wait: &[vk::SemaphoreSubmitInfo<'_>]) {
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(self.commands)];
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&buffers).wait_semaphore_infos(wait)];
        // SAFETY: the commands were begun, the fence is not in use.
        unsafe {
            self.device.end_command_buffer(self.commands).unwrap();
            self.device.queue_submit2(self.queue.handle, &submit, self.fence).unwrap();
            self.device.wait_for_fences(&[self.fence], true, u64::MAX).unwrap();
            self.device.reset_fences(&[self.fence]).unwrap();
        }
    }

    /// A frame with the bake in it, and drawn with the light map if there is something to draw with.
    pub(crate) fn record_frame(
        &mut self,
        baker: &mut Baker,
        budget: Duration,
        draw: Option<&mut Draw>,
    ) -> (FrameReport, Option<FrameTiming>) {
        self.begin();
        // SAFETY: the command buffer is being recorded, outside a rendering, and is submitted below.
        let commands = unsafe { FrameCommands::new(self.commands) };
        let report = counting::frame(|| baker.record(commands, budget)).unwrap();
        if let Some(draw) = draw {
            draw.record(&self.device, self.commands, baker.light_map());
        }
        self.end(&[]);
        (report, counting::frame(|| baker.complete(report.frame)).unwrap())
    }

    /// A frame whose bake is submitted beside the drawing, which does not wait for it.
    pub(crate) fn submit_frame(
        &mut self,
        baker: &mut Baker,
        budget: Duration,
        draw: Option<&mut Draw>,
    ) -> (FrameReport, Option<FrameTiming>) {
        let point = |value| {
            // SAFETY: a timeline semaphore that lives until the engine is finished; values grow.
            unsafe { TimelinePoint::new(self.timeline, value) }
        };
        let (wait, signal) = (point(self.reached), point(self.reached + 1));
        let report = counting::frame(|| baker.submit(budget, &[wait], &[signal])).unwrap();
        self.begin();
        if let Some(draw) = draw {
            draw.record(&self.device, self.commands, baker.light_map());
        }
        // What the last frame signalled: its light map is the newest that can be had.
        let seen = [vk::SemaphoreSubmitInfo::default()
            .semaphore(self.timeline)
            .value(self.reached)
            .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)];
        self.end(&seen);
        self.reached += 1;
        let (semaphores, values) = ([self.timeline], [self.reached]);
        let info = vk::SemaphoreWaitInfo::default().semaphores(&semaphores).values(&values);
        // SAFETY: the semaphore is signalled by the submission above.
        unsafe { self.device.wait_semaphores(&info, u64::MAX).unwrap() };
        (report, counting::frame(|| baker.complete(report.frame)).unwrap())
    }

    /// Destroys everything in the documented order, bakers having been dropped before, and fails on any message.
    pub(crate) fn finish(mut self) {
        self.gpu = None;
        // SAFETY: every frame was waited for, and all that was made from the device is gone.
        unsafe {
            self.device.destroy_semaphore(self.timeline, None);
            self.device.destroy_fence(self.fence, None);
            self.device.destroy_command_pool(self.pool, None);
            self.device.destroy_device(None);
            let functions = ext::debug_utils::Instance::new(&self.entry, &self.instance);
            let messages = std::mem::take(&mut *self.messages.lock().unwrap());
            functions.destroy_debug_utils_messenger(self.messenger, None);
            self.instance.destroy_instance(None);
            assert_eq!(messages, Vec::<String>::new());
        }
    }
}

fn skip_or_fail(backend: BackendChoice, error: &lightoven::Error) {
    let required = std::env::var("LIGHTOVEN_REQUIRE").is_ok_and(|required| required == "ray_query");
    assert!(backend == BackendChoice::RayQuery && !required, "{error}");
    println!("skipped: {error}");
}

type Watched = (ash::Instance, vk::DebugUtilsMessengerEXT, Box<Mutex<Vec<String>>>);

unsafe fn create_instance(entry: &ash::Entry) -> Watched {
    let messages = Box::new(Mutex::new(Vec::new()));
    let layers = [c"VK_LAYER_KHRONOS_validation".as_ptr()];
    let extensions = INSTANCE_EXTENSIONS.map(CStr::as_ptr);
    let application = vk::ApplicationInfo::default().application_name(c"engine").api_version(vk::API_VERSION_1_3);
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    let info = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_layer_names(&layers)
        .enabled_extension_names(&extensions)
        .push_next(&mut features);
    let severity = vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING;
    let watch = vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(severity)
        .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
        .pfn_user_callback(Some(receive))
        .user_data(std::ptr::from_ref(&*messages).cast_mut().cast());
    // SAFETY: the descriptions are complete; the messages outlive the messenger.
    unsafe {
        let instance = entry.create_instance(&info, None).expect("there are a driver and the validation layers");
        let functions = ext::debug_utils::Instance::new(entry, &instance);
        let messenger = functions.create_debug_utils_messenger(&watch, None).unwrap();
        (instance, messenger, messages)
    }
}
