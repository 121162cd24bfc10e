#version 460
// Light-map-space g-buffer: for each triangle the box of texels that it may touch.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/scene.glsl"

// Triangles to draw, those of one pair of textures together.
layout(set = 0, binding = 5, std430) readonly buffer Batches { uint batches[]; };

layout(location = 0) flat out uint out_primitive;
layout(location = 1) flat out vec2 out_t0;
layout(location = 2) flat out vec2 out_t1;
layout(location = 3) flat out vec2 out_t2;

void main() {
    uint corner = uint(gl_VertexIndex) % 6u;
    out_primitive = batches[uint(gl_VertexIndex) / 6u];
    gl_Position = vec4(2.0, 2.0, 0.0, 1.0);
    if ((primitives[out_primitive].flags & PRIMITIVE_MAPPED) == 0u) {
        out_t0 = out_t1 = out_t2 = vec2(0.0);
        return;
    }
    out_t0 = corner_texel(push.instance, out_primitive, 0u);
    out_t1 = corner_texel(push.instance, out_primitive, 1u);
    out_t2 = corner_texel(push.instance, out_primitive, 2u);
    vec2 lo = floor(min(out_t0, min(out_t1, out_t2)) - 0.01);
    vec2 hi = ceil(max(out_t0, max(out_t1, out_t2)) + 0.01);
    bvec2 high = bvec2(corner == 1u || corner == 2u || corner == 4u, corner >= 2u && corner != 3u);
    gl_Position = vec4(mix(lo, hi, vec2(high)) / vec2(push.map_size) * 2.0 - 1.0, 0.0, 1.0);
}
