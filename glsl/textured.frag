#version 460
// gbuffer.frag of a scene with textures: beside the texel's surface the mean of one kind of texture over the texel. Drawn
// once for albedo and once for emission, where the scene has such.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/gbuffer.glsl"

layout(set = 0, binding = 13) uniform sampler2D picture;
// `[3 * primitive + corner]`
layout(set = 0, binding = 14, std430) readonly buffer Texcoords { vec2 texcoords[]; };

layout(location = 0) out uvec4 out_surface;
layout(location = 1) out vec4 out_tint;

void main() {
    Drawn drawn = draw();
    gl_FragDepth = drawn.depth;
    out_surface = surface_of(drawn);
    out_tint = vec4(0.0);
    if (!drawn.touches) return;
    // The texel's own extent in the texture, so that the mip level is the texel's mean.
    vec2 b = drawn.barycentrics;
    vec2 bx = vec2(in_t2.y - in_t0.y, in_t0.y - in_t1.y) / drawn.area;
    vec2 by = vec2(in_t0.x - in_t2.x, in_t1.x - in_t0.x) / drawn.area;
    vec2 uv = texcoords[3u * in_primitive];
    vec2 e1 = texcoords[3u * in_primitive + 1u] - uv, e2 = texcoords[3u * in_primitive + 2u] - uv;
    vec2 place = uv + e1 * b.x + e2 * b.y;
    // Materials' own factors are applied where the map is read: that of emission may change.
    out_tint = vec4(textureGrad(picture, place, e1 * bx.x + e2 * bx.y, e1 * by.x + e2 * by.y).rgb, 1.0);
}
