// The scene's buffers.
#ifndef SCENE_GLSL
#define SCENE_GLSL

layout(set = 0, binding = 1, std430) readonly buffer Triangles { Triangle triangles[]; };
layout(set = 0, binding = 2, std430) readonly buffer Primitives { Primitive primitives[]; };
layout(set = 0, binding = 3, std430) readonly buffer Instances { Instance instances[]; };
layout(set = 0, binding = 4, std430) readonly buffer Materials { Material materials[]; };

vec3 to_world_point(uint instance, vec3 p) {
    if (!INSTANCES) return p;
    vec4 h = vec4(p, 1.0);
    return vec3(dot(instances[instance].object_to_world[0], h), dot(instances[instance].object_to_world[1], h),
                dot(instances[instance].object_to_world[2], h));
}

vec3 to_world_vector(uint instance, vec3 v) {
    if (!INSTANCES) return v;
    return vec3(dot(instances[instance].object_to_world[0].xyz, v), dot(instances[instance].object_to_world[1].xyz, v),
                dot(instances[instance].object_to_world[2].xyz, v));
}

// By the inverse transposed, which is the cofactor matrix but for a positive factor or the sign of the determinant;
// the sign goes, so that a mirrored object's normals still point away from it.
vec3 to_world_normal(uint instance, vec3 n) {
    if (!INSTANCES) return n;
    return normalize(instances[instance].world_to_object[0].xyz * n.x + instances[instance].world_to_object[1].xyz * n.y
                     + instances[instance].world_to_object[2].xyz * n.z);
}

vec3 octahedral(uint code) {
    vec2 e = unpackSnorm2x16(code);
    vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
    return normalize(n);
}

// Light-map coordinates in texels of corner `i`.
vec2 corner_texel(uint instance, uint primitive, uint i) {
    vec4 atlas = instances[instance].atlas;
    return primitives[primitive].uvs[i] * atlas.xy + atlas.zw;
}

#endif
