//! The scene as acceleration structures, for the hardware back end: one bottom level a mesh, over the same triangles
//! and in the same order as the host-built hierarchy, so that both back ends name a triangle alike.

use super::commands::Commands;
use super::memory::{Buffer, BufferDesc, Location};
use super::recorder::PassKind;
use super::{Gpu, vulkan_error};
use crate::bvh::{Bvh, InstanceRecord, MeshRange, Triangle};
use crate::error::{Error, ErrorKind, Result};
use ash::{khr, vk};

/// A scene's acceleration structures.
pub(crate) struct SceneStructure {
    top: Structure,
    _bottom: Vec<Option<Structure>>,
}

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
        let record = |(index, instance): (usize, &InstanceRecord)| {
            let structure = bottom[bvh.mesh_of(index)].as_ref();
            record(index, instance, structure.map_or(0, |structure| structure.address))
        };
        let records = bvh.instances.iter().enumerate().map(record);
        let records: Vec<[u8; INSTANCE_BYTES]> = records.collect();
        let top = top_level(gpu, commands, &records)?;
        Ok(Self { top, _bottom: bottom })
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

const INSTANCE_BYTES: usize = size_of::<vk::AccelerationStructureInstanceKHR>();

/// An instance as the device reads it: transform rows, custom index and mask, flags, bottom level.
fn record(index: usize, instance: &InstanceRecord, bottom: vk::DeviceAddress) -> [u8; INSTANCE_BYTES] {
    let mut bytes = [0; INSTANCE_BYTES];
    bytes[..48].copy_from_slice(bytemuck::bytes_of(&instance.object_to_world));
    bytes[48..52].copy_from_slice(&(index as u32 & 0x00ff_ffff | 0xff00_0000).to_le_bytes());
    // The default front is clockwise in a left-handed system, so counter-clockwise in glTF's right-handed one.
    let flags = vk::GeometryInstanceFlagsKHR::empty().as_raw();
    bytes[52..56].copy_from_slice(&(flags << 24).to_le_bytes());
    bytes[56..].copy_from_slice(&bottom.to_le_bytes());
    bytes
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
    build(gpu, commands, vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL, geometry, mesh.count)
}

fn top_level(gpu: &Gpu, commands: &mut Commands, records: &[[u8; INSTANCE_BYTES]]) -> Result<Structure> {
    let usage = vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR
        | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS;
    let bytes = records.as_flattened();
    let desc = BufferDesc { name: "instance structures", size: bytes.len() as u64, usage, location: Location::Device };
    let buffer = commands.upload(desc, bytes)?;
    let data = vk::AccelerationStructureGeometryInstancesDataKHR::default()
        .data(vk::DeviceOrHostAddressConstKHR { device_address: buffer.address() });
    let geometry = vk::AccelerationStructureGeometryKHR::default()
        .geometry_type(vk::GeometryTypeKHR::INSTANCES)
        .geometry(vk::AccelerationStructureGeometryDataKHR { instances: data });
    build(gpu, commands, vk::AccelerationStructureTypeKHR::TOP_LEVEL, geometry, records.len() as u32)
}

fn build(
    gpu: &Gpu,
    commands: &mut Commands,
    kind: vk::AccelerationStructureTypeKHR,
    geometry: vk::AccelerationStructureGeometryKHR<'_>,
    count: u32,
) -> Result<Structure> {
    let functions = functions(gpu)?;
    let geometries = [geometry];
    let mut info = vk::AccelerationStructureBuildGeometryInfoKHR::default()
        .ty(kind)
        .flags(vk::BuildAccelerationStructureFlagsKHR::PREFER_FAST_TRACE)
        .mode(vk::BuildAccelerationStructureModeKHR::BUILD)
        .geometries(&geometries);
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
    info.dst_acceleration_structure = structure.handle;
    info.scratch_data.device_address = scratch.address().next_multiple_of(SCRATCH_ALIGNMENT);
    let range = [vk::AccelerationStructureBuildRangeInfoKHR::default().primitive_count(count)];
    commands.run(|recorder| {
        let scope = recorder.pass(PassKind::Build, "build structure");
        // SAFETY: structure, scratch and inputs are alive until the run below has been waited for.
        unsafe { functions.cmd_build_acceleration_structures(recorder.commands(), &[info], &[&range]) };
        drop(scope);
        Ok(())
    })?;
    Ok(structure)
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
