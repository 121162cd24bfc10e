#version 460
// Gathers light: rays from every texel, whose hits read the source map. In the words of Wizard: a ray is emitted with a
// weight, its hit or miss adds weight times radiance, and the accumulator averages; a ray never spawns another.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "include/rays.glsl"
#include "include/random.glsl"
#include "include/sampling.glsl"
#include "include/texels.glsl"
#include "include/sky.glsl"

layout(set = 0, binding = 9, r32ui) readonly uniform uimage2D footprint_image;
layout(set = 0, binding = 10) uniform texture2D source_map;
// Mean irradiance of the even and of the odd quanta, and how many samples each holds. Dynamic: the running average, and
// what the last visit gathered; both with their quanta.
layout(set = 0, binding = 11, rgba32f) uniform image2D mean_even;
layout(set = 0, binding = 12, rgba32f) uniform image2D mean_odd;
layout(set = 0, binding = 18, rgba32f) readonly uniform image2D emission_image;

const uint FOOTPRINT_TRIES = 4u;

// A point of the texel that lies on its triangle and within its footprint.
vec2 choose_point(Surface s, vec4 sides, uint texel, uint sample_index, vec2 u) {
    for (uint attempt = 1u; attempt <= FOOTPRINT_TRIES; ++attempt) {
        vec2 p = mix(sides.xy, sides.zw, u);
        if (on_triangle(s, p)) return p;
        u = random4(texel, sample_index, attempt).xy;
    }
    return clamp(s.start, sides.xy, sides.zw);
}

// In a dynamic scene the source map holds what is reflected, and emission, which may change at any time, is added here.
vec3 emitted(uint primitive, ivec2 texel) {
    vec3 emission = materials[primitives[primitive].material].emission;
    return TEXTURES && emission != vec3(0.0) ? emission * imageLoad(emission_image, texel).rgb : emission;
}

vec3 on_hit(Hit hit) {
    uint flags = primitives[hit.primitive].flags;
    if (SINGLE_SIDED && !hit.front_face && (flags & PRIMITIVE_DOUBLE_SIDED) == 0u) return vec3(0.0);
    if (UNMAPPED && (flags & PRIMITIVE_MAPPED) == 0u) return materials[primitives[hit.primitive].material].emission;
    vec2 t0 = corner_texel(hit.instance, hit.primitive, 0u);
    vec2 t1 = corner_texel(hit.instance, hit.primitive, 1u);
    vec2 t2 = corner_texel(hit.instance, hit.primitive, 2u);
    vec2 place = t0 + (t1 - t0) * hit.barycentrics.x + (t2 - t0) * hit.barycentrics.y;
    ivec2 texel = clamp(ivec2(place), ivec2(0), ivec2(push.map_size) - 1);
    vec3 source = texelFetch(source_map, texel, 0).rgb;
    return DYNAMIC ? source + emitted(hit.primitive, texel) : source;
}

vec3 on_miss(vec3 direction) {
    return sky_radiance(direction);
}

// Radiance that one cosine-distributed ray sees.
vec3 emit(Surface s, mat3 frame, vec4 sides, uint texel, uint stratum, uint sample_index) {
    vec4 u = random4(texel, sample_index, 0u);
    vec3 direction = frame * cosine_direction(stratified(stratum, push.strata_side, u.xy));
    // Under the triangle, where only the shading normal looks: nothing comes from there.
    if (dot(direction, s.geometric_normal) <= 0.0) return vec3(0.0);
    vec3 point = point_at(s, choose_point(s, sides, texel, sample_index, u.zw));
    Hit hit = trace_closest(ray_from(s, point, direction, 1e30));
    return hit.committed ? on_hit(hit) : on_miss(direction);
}

// Mean irradiance of a quantum.
vec3 gather(Surface s, mat3 frame, vec4 sides, uint key, uint quantum) {
    uint samples = push.strata_side * push.strata_side;
    uint first = push.first_sample + quantum * samples;
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < samples; ++i) sum += emit(s, frame, sides, key, i, first + i);
    // A cosine-distributed ray weighs pi.
    return sum * (PI / float(samples));
}

// Merges a quantum's mean into the running one: no sum that outgrows its addends.
void accumulate(inout vec4 mean, vec3 quantum_mean, float samples) {
    mean.w += samples;
    mean.rgb += (quantum_mean - mean.rgb) * (samples / mean.w);
}

// Static: the halves. The first quantum starts anew: what an earlier epoch left stays readable until then.
void gather_halves(Surface s, mat3 frame, vec4 sides, ivec2 texel, uint key) {
    bool anew = push.first_quantum == 0u;
    vec4 even = anew ? vec4(0.0) : imageLoad(mean_even, texel);
    vec4 odd = anew ? vec4(0.0) : imageLoad(mean_odd, texel);
    float samples = float(push.strata_side * push.strata_side);
    for (uint quantum = push.first_quantum; quantum < push.first_quantum + push.quantum_count; ++quantum) {
        vec3 quantum_mean = gather(s, frame, sides, key, quantum);
        if ((quantum & 1u) == 0u) accumulate(even, quantum_mean, samples);
        else accumulate(odd, quantum_mean, samples);
    }
    imageStore(mean_even, texel, even);
    imageStore(mean_odd, texel, odd);
}

// Dynamic: the running average (src/temporal.rs), and beside it what this visit alone has gathered.
void gather_average(Surface s, mat3 frame, vec4 sides, ivec2 texel, uint key) {
    vec4 average = push.history > 0.0 ? imageLoad(mean_even, texel) : vec4(0.0);
    // A texel whose instance was absent has none, whatever its tile has.
    float history = average.w > 0.0 ? push.history : 0.0;
    vec4 visit = vec4(0.0);
    for (uint i = 0u; i < push.quantum_count; ++i) {
        vec3 quantum_mean = gather(s, frame, sides, key, push.first_quantum + i);
        // What is no number would stay in the average for good.
        if (any(isnan(quantum_mean)) || any(isinf(quantum_mean))) quantum_mean = average.rgb;
        average.rgb += (quantum_mean - average.rgb) / (history + float(i + 1u));
        accumulate(visit, quantum_mean, 1.0);
    }
    imageStore(mean_even, texel, vec4(average.rgb, history + visit.w));
    imageStore(mean_odd, texel, visit);
}

void main() {
    uvec2 texel;
    if (!texel_of_invocation(texel)) return;
    uvec4 g = imageLoad(surface_image, ivec2(texel));
    if (DYNAMIC && (instances[g.x - 1u].flags & INSTANCE_ABSENT) != 0u) return;
    Surface s = surface_of(texel, g);
    vec4 sides = unpack_footprint(imageLoad(footprint_image, ivec2(texel)).x);
    mat3 frame = frame_of(s.normal);
    uint key = texel.x | texel.y << 16u;
    if (DYNAMIC) gather_average(s, frame, sides, ivec2(texel), key);
    else gather_halves(s, frame, sides, ivec2(texel), key);
}
