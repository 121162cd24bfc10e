#version 460
// gbuffer.frag of a scene with textures: the texel's albedo and emission beside its surface.
#extension GL_GOOGLE_include_directive : require
#include "include/layout.glsl"
#include "include/gbuffer.glsl"

layout(set = 0, binding = 13) uniform sampler2D albedo_texture;
layout(set = 0, binding = 14) uniform sampler2D emission_texture;
layout(set = 0, binding = 15, std430) readonly buffer Texture_coordinates { Texcoords texcoords[]; };

layout(location = 0) out uvec4 out_surface;
layout(location = 1) out vec4 out_albedo;
layout(location = 2) out vec4 out_emission;

void main() {
    Drawn drawn = draw();
    gl_FragDepth = drawn.depth;
    out_surface = surface_of(drawn);
    out_albedo = out_emission = vec4(0.0);
    if (!drawn.touches) return;
    // The texel's own extent in the texture, so that the mip level is the texel's mean.
    vec2 b = drawn.barycentrics;
    vec2 bx = vec2(in_t2.y - in_t0.y, in_t0.y - in_t1.y) / drawn.area;
    vec2 by = vec2(in_t0.x - in_t2.x, in_t1.x - in_t0.x) / drawn.area;
    Texcoords uv = texcoords[in_primitive];
    vec2 a1 = uv.albedo[1] - uv.albedo[0], a2 = uv.albedo[2] - uv.albedo[0];
    vec2 m1 = uv.emission[1] - uv.emission[0], m2 = uv.emission[2] - uv.emission[0];
    vec3 albedo = textureGrad(albedo_texture, uv.albedo[0] + a1 * b.x + a2 * b.y, a1 * bx.x + a2 * bx.y,
                              a1 * by.x + a2 * by.y).rgb;
    vec3 emission = textureGrad(emission_texture, uv.emission[0] + m1 * b.x + m2 * b.y, m1 * bx.x + m2 * bx.y,
                                m1 * by.x + m2 * by.y).rgb;
    out_albedo = vec4(materials[primitives[in_primitive].material].albedo * albedo, 1.0);
    // The material's own factor is applied where the map is read: it may change.
    out_emission = vec4(emission, 1.0);
}
