// The list of texels that are baked, in blocks of 8 x 8 so that neighbours share a work group.
#ifndef TEXELS_GLSL
#define TEXELS_GLSL

layout(set = 0, binding = 5, std430) readonly buffer Texels { uint texels[]; };

layout(local_size_x = 64) in;

// Work groups lie in rows, for there may be more than fit along one axis.
uint work_group() {
    return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

// Whether this work group is one of those that have texels, and so a place among the sums.
bool has_sum() {
    return work_group() * gl_WorkGroupSize.x < max(push.texel_count, 1u);
}

// Within what is dispatched.
uint index_of_invocation() {
    return work_group() * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

// Which of the two fields of its work group a texel is in: rows of eight take turns, so that lanes that share their
// instructions are in one.
uint field_of_invocation() {
    return gl_LocalInvocationID.x >> 3u & 1u;
}

// Whether this invocation has a texel, and which.
bool texel_of_invocation(out uvec2 texel) {
    uint index = index_of_invocation();
    if (index >= push.texel_count) return false;
    uint code = texels[push.first_texel + index];
    texel = uvec2(code & 0xffffu, code >> 16u);
    return true;
}

#endif
