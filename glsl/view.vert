#version 460
// The benchmark's camera pass.
#extension GL_GOOGLE_include_directive : require
#include "include/stage.glsl"

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_texel;
layout(location = 3) out vec2 out_albedo_uv;
layout(location = 4) out vec2 out_emission_uv;
layout(location = 5) flat out uint out_material;
layout(location = 6) flat out uint out_mapped;

// A plane's normal goes with the cofactors, which unlike the inverse exist for every transform.
vec3 world_normal(vec3 normal, vec4 rows[3]) {
    vec3 x = rows[0].xyz, y = rows[1].xyz, z = rows[2].xyz;
    vec3 turned = vec3(dot(cross(y, z), normal), dot(cross(z, x), normal), dot(cross(x, y), normal));
    return dot(x, cross(y, z)) < 0.0 ? -turned : turned;
}

void main() {
    Vertex vertex = vertices[gl_VertexIndex];
    Placing placing = placings[gl_InstanceIndex];
    out_position = world_position(gl_VertexIndex, gl_InstanceIndex);
    out_normal = world_normal(vertex.normal, placing.object_to_world);
    out_texel = vertex.light_map_uv * placing.scale + placing.offset;
    out_albedo_uv = vertex.albedo_uv;
    out_emission_uv = vertex.emission_uv;
    out_material = vertex.material;
    out_mapped = vertex.mapped;
    gl_Position = frame.world_to_clip * vec4(out_position, 1.0);
}
