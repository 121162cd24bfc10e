// The list of texels that are baked, in blocks of 8 x 8 so that neighbours share a work group.
#ifndef TEXELS_GLSL
#define TEXELS_GLSL

layout(set = 0, binding = 5, std430) readonly buffer Texels { uint texels[]; };

layout(local_size_x = 64) in;

// Whether this invocation has a texel, and which.
bool texel_of_invocation(out uvec2 texel) {
    uint index = gl_GlobalInvocationID.x;
    if (index >= push.texel_count) return false;
    uint code = texels[push.first_texel + index];
    texel = uvec2(code & 0xffffu, code >> 16u);
    return true;
}

#endif
