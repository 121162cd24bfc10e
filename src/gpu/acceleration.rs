//! The scene as acceleration structures, for the hardware back end: one bottom level a mesh, over the same triangles
//! and in the same order as the host-built hierarchy, so that both back ends name a triangle alike.

use super::commands::Commands;
use super::memory::{Buffer, BufferDesc, Location};
use super::recorder::{PassKind, Recorder};
use super::{Gpu, vulkan_error};
use crate::bvh::{Bvh, InstanceRecord, MeshRange, Triangle};
use crate::error::{Error, ErrorKind, Result};
use ash::{khr, vk};

/// A scene's acceleration structures.
pub(crate) struct SceneStructure {
    gpu: Gpu,
    top: Structure,
    bottom: Vec<Option<Structure>>,
    /// What the top level is built from.
    records: Vec<Record>,
    record_buffer: Buffer,
    scratch: Buffer,
}

/// An instance as the device reads it.
type Record = [u8; size_of::<vk::AccelerationStructureInstanceKHR>()];

/// One structure with the buffer that it lies in.
struct Structure {
    gpu: Gpu,
    handle: vk::AccelerationStructureKHR,
    address: vk::DeviceAddress,
    _buffer: Buffer,
}

impl SceneStructure {
    /// `triangles` holds the hierarchy's triangles.
    pub(crate) fn new(gpu: &Gpu, commands: &mut Commands, bvh: &Bvh, triangles: &Buffer) -> Result<Self> {
        // A mesh without triangles has no structure, and its instances refer to none: they are inactive.
        let build =
            |mesh: &MeshRange| (mesh.count > 0).then(|| bottom_level(gpu, commands, mesh, triangles)).transpose();
        let bottom = bvh.meshes.iter().map(build).collect::<Result<Vec<_>>>()?;
        let records = records(bvh, &bottom).collect::<Vec<_>>();
        let usage = vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR
            | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS;
        let bytes = records.as_flattened();
        let size = bytes.len() as u64;
        let desc = BufferDesc { name: "instance structures", size, usage, location: Location::Device };
        let record_buffer = commands.upload(desc, bytes)?;
        let geometry = instances_of(&record_buffer);
        let kind = vk::AccelerationStructureTypeKHR::TOP_LEVEL;
        let (top, scratch) = create(gpu, kind, geometry, records.len() as u32)?;
        let structure = Self { gpu: gpu.clone(), top, bottom, records, record_buffer, scratch };
        commands.run(|recorder| structure.record_build(recorder))?;
        Ok(structure)
    }

    /// Builds the top level anew, where the instances now are.
    pub(crate) fn rebuild(&mut self, recorder: &mut Recorder<'_>, bvh: &Bvh) -> Result<()> {
        self.records.clear();
        self.records.extend(records(bvh, &self.bottom));
        recorder.update_buffer(&self.record_buffer, 0, self.records.as_flattened());
        self.record_build(recorder)
    }

    fn record_build(&self, recorder: &mut Recorder<'_>) -> Result<()> {
        let geometry = instances_of(&self.record_buffer);
        let kind = vk::AccelerationStructureTypeKHR::TOP_LEVEL;
        record_build(&self.gpu, recorder, kind, geometry, self.records.len() as u32, &self.top, &self.scratch)
    }

    pub(super) fn top_level(&self) -> vk::AccelerationStructureKHR {
        self.top.handle
    }
}

impl Drop for Structure {
    fn drop(&mut self) {
        if let Some(functions) = &self.gpu.inner.acceleration {
            // SAFETY: whoever recorded with it has waited for the device before dropping it.
            unsafe { functions.destroy_acceleration_structure(self.handle, None) };
        }
    }
}

/// Transform rows, custom index and mask, flags, bottom level.
fn records<'a>(bvh: &'a Bvh, bottom: &'a [Option<Structure>]) -> impl Iterator<Item = Record> + 'a {
    bvh.instances.iter().enumerate().map(|(index, instance)| {
        let structure = bottom[bvh.mesh_of(index)].as_ref().map_or(0, |structure| structure.address);
        let mask: u32 = if instance.flags & InstanceRecord::ABSENT == 0 { 0xff00_0000 } else { 0 };
        // The default front is clockwise in a left-handed system, so counter-clockwise in glTF's right-handed one.
        let flags = vk::GeometryInstanceFlagsKHR::empty().as_raw();
        let mut record = [0; size_of::<Record>()];
        record[..48].copy_from_slice(bytemuck::bytes_of(&instance.object_to_world));
        record[48..52].copy_from_slice(&(index as u32 & 0x00ff_ffff | mask).to_le_bytes());
        record[52..56].copy_from_slice(&(flags << 24).to_le_bytes());
        record[56..].copy_from_slice(&structure.to_le_bytes());
        record
    })
}

fn bottom_level(gpu: &Gpu, commands: &mut Commands, mesh: &MeshRange, triangles: &Buffer) -> Result<Structure> {
    let offset = u64::from(mesh.first_primitive) * size_of::<Triangle>() as u64;
    let data = vk::AccelerationStructureGeometryTrianglesDataKHR::default()
        .vertex_format(vk::Format::R32G32B32_SFLOAT)
        .vertex_data(vk::DeviceOrHostAddressConstKHR { device_address: triangles.address() + offset })
        .vertex_stride(16)
        .max_vertex((3 * mesh.count).saturating_sub(1))
        .index_type(vk::IndexType::NONE_KHR);
    let geometry = vk::AccelerationStructureGeometryKHR::default()
        .geometry_type(vk::GeometryTypeKHR::TRIANGLES)
        .geometry(vk::AccelerationStructureGeometryDataKHR { triangles: data });
    let kind = vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL;
    let (structure, scratch) = create(gpu, kind, geometry, mesh.count)?;
    commands.run(|recorder| record_build(gpu, recorder, kind, geometry, mesh.count, &structure, &scratch))?;
    Ok(structure)
}

fn instances_of(records: &Buffer) -> vk::AccelerationStructureGeometryKHR<'static> {
    let data = vk::AccelerationStructureGeometryInstancesDataKHR::default()
        .data(vk::DeviceOrHostAddressConstKHR { device_address: records.address() });
    vk::AccelerationStructureGeometryKHR::default()
        .geometry_type(vk::GeometryTypeKHR::INSTANCES)
        .geometry(vk::AccelerationStructureGeometryDataKHR { instances: data })
}

/// A structure of the right size, not yet built, and the memory that building takes.
fn create(
    gpu: &Gpu,
    kind: vk::AccelerationStructureTypeKHR,
    geometry: vk::AccelerationStructureGeometryKHR<'_>,
    count: u32,
) -> Result<(Structure, Buffer)> {
    let functions = functions(gpu)?;
    let geometries = [geometry];
    let info = build_info(kind, &geometries);
    let mut sizes = vk::AccelerationStructureBuildSizesInfoKHR::default();
    let on_device = vk::AccelerationStructureBuildTypeKHR::DEVICE;
    // SAFETY: the description is complete but for addresses, which sizes do not depend on.
    unsafe { functions.get_acceleration_structure_build_sizes(on_device, &info, &[count], &mut sizes) };
    let structure = allocate(gpu, functions, kind, sizes.acceleration_structure_size)?;
    let scratch = Buffer::new(
        gpu,
        BufferDesc {
            name: "structure build scratch",
            size: sizes.build_scratch_size + SCRATCH_ALIGNMENT,
            usage: vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS,
            location: Location::Device,
        },
    )?;
    Ok((structure, scratch))
}

fn build_info<'a>(
    kind: vk::AccelerationStructureTypeKHR,
    geometries: &'a [vk::AccelerationStructureGeometryKHR<'a>],
) -> vk::AccelerationStructureBuildGeometryInfoKHR<'a> {
    vk::AccelerationStructureBuildGeometryInfoKHR::default()
        .ty(kind)
        .flags(vk::BuildAccelerationStructureFlagsKHR::PREFER_FAST_TRACE)
        .mode(vk::BuildAccelerationStructureModeKHR::BUILD)
        .geometries(geometries)
}

fn record_build(
    gpu: &Gpu,
    recorder: &mut Recorder<'_>,
    kind: vk::AccelerationStructureTypeKHR,
    geometry: vk::AccelerationStructureGeometryKHR<'_>,
    count: u32,
    structure: &Structure,
    scratch: &Buffer,
) -> Result<()> {
    let functions = functions(gpu)?;
    let geometries = [geometry];
    let mut info = build_info(kind, &geometries).dst_acceleration_structure(structure.handle);
    info.scratch_data.device_address = scratch.address().next_multiple_of(SCRATCH_ALIGNMENT);
    let range = [vk::AccelerationStructureBuildRangeInfoKHR::default().primitive_count(count)];
    let scope = recorder.pass(PassKind::Build, c"build structure");
    // SAFETY: structure, scratch and inputs outlive the command buffer's execution: the caller waits for it, or keeps them
    // until the frame is complete; what was recorded before waits at the pass's barrier.
    // Not ash's wrapper, which allocates.
    unsafe {
        let build = functions.fp().cmd_build_acceleration_structures_khr;
        build(recorder.commands(), 1, &info, &range.as_ptr());
    }
    drop(scope);
    Ok(())
}

/// At least minAccelerationStructureScratchOffsetAlignment of every known device.
const SCRATCH_ALIGNMENT: u64 = 256;

fn allocate(
    gpu: &Gpu,
    functions: &khr::acceleration_structure::Device,
    kind: vk::AccelerationStructureTypeKHR,
    size: u64,
) -> Result<Structure> {
    let usage = vk::BufferUsageFlags::ACCELERATION_STRUCTURE_STORAGE_KHR | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS;
    let buffer =
        Buffer::new(gpu, BufferDesc { name: "acceleration structure", size, usage, location: Location::Device })?;
    let info = vk::AccelerationStructureCreateInfoKHR::default().buffer(buffer.handle).size(size).ty(kind);
    // SAFETY: the buffer was made for it and is large enough.
    let handle = unsafe { functions.create_acceleration_structure(&info, None) }
        .map_err(|result| vulkan_error("create an acceleration structure", result))?;
    let info = vk::AccelerationStructureDeviceAddressInfoKHR::default().acceleration_structure(handle);
    // SAFETY: the structure was just made.
    let address = unsafe { functions.get_acceleration_structure_device_address(&info) };
    Ok(Structure { gpu: gpu.clone(), handle, address, _buffer: buffer })
}

fn functions(gpu: &Gpu) -> Result<&khr::acceleration_structure::Device> {
    let missing = || Error::new(ErrorKind::Unsupported, "the device was made without VK_KHR_acceleration_structure");
    gpu.inner.acceleration.as_ref().ok_or_else(missing)
}
