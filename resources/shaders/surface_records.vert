#version 330 core
// Edge records in, view space out: positions and normals are made here, as vertexOf() in
// core/extract/live/edge_record.h makes them.
layout(location = 0) in uvec4 record; // edge, or 3072 + level of the cell; level of the leaf edge, or upper half of z; two normals
layout(location = 1) in vec2 scalars; // at both ends; inside a cell: x and y
layout(location = 2) in vec4 tint; // linear light; a: 0 hidden, half plain, 1 in this colour; (0, 0, 0, 1) without tints

uniform usamplerBuffer places; // of the brick of each 16 records
uniform float isovalue;
uniform mat4 modelToView;
uniform mat4 viewToClip;
uniform mat3 normalToView;
uniform vec4 cuts[7]; // half-spaces that what is drawn lies in: dot(xyz, place) + w >= 0, grid index units
uniform int cutCount;

out vec3 viewPosition;
out vec3 viewNormal;
out vec3 gridPosition;
out vec3 gridNormal;
out float leafLevel;
flat out vec4 tintColour;
out float gl_ClipDistance[7];

// Not of unit length; zero for a point without gradient.
vec3 directionOf(uint code) {
    if (code == 0x8080u)
        return vec3(0.0);
    vec2 place = vec2(int(code << 24u) >> 24, int(code << 16u) >> 24) * (1.0 / 127.0);
    float z = 1.0 - abs(place.x) - abs(place.y);
    float fold = max(-z, 0.0);
    place.x += place.x >= 0.0 ? -fold : fold;
    place.y += place.y >= 0.0 ? -fold : fold;
    return vec3(place, z);
}

void placeInside(vec3 brick) {
    gridPosition = brick + vec3(scalars, uintBitsToFloat(record.y << 16u | record.w));
    vec3 direction = directionOf(record.z);
    float size = sqrt(dot(direction, direction));
    gridNormal = size > 0.0 ? direction / size : direction;
}

void placeOnEdge(vec3 brick) {
    uint axis = record.x >> 10u;
    uint point = record.x & 1023u;
    vec3 along = vec3(axis == 0u, axis == 1u, axis == 2u);
    // Halves, so that differences of large numbers stay finite; what is not a number becomes 0.
    float t = (isovalue * 0.5 - scalars.x * 0.5) / (scalars.y * 0.5 - scalars.x * 0.5);
    t = t > 0.0 ? t : 0.0;
    t = t < 1.0 ? t : 1.0;
    uint side = 1u << record.y;
    uvec3 first = uvec3(point % 9u, point / 9u % 9u, point / 81u);
    first[axis] &= ~(side - 1u); // leaf edges are aligned at multiples of their length
    gridPosition = brick + vec3(first) + along * (t * float(side));
    vec3 lower = directionOf(record.z), upper = directionOf(record.w);
    vec3 sum = lower + t * (upper - lower);
    float square = dot(sum, sum);
    gridNormal = square < 1e-12 ? along * (scalars.x < scalars.y ? -1.0 : 1.0) : sum * (1.0 / sqrt(square));
}

void main() {
    vec3 brick = 8.0 * vec3(texelFetch(places, gl_VertexID >> 4).xyz);
    if (record.x >= 3072u)
        placeInside(brick);
    else
        placeOnEdge(brick);
    leafLevel = float(record.x >= 3072u ? record.x - 3072u : record.y);
    vec4 place = modelToView * vec4(gridPosition, 1.0);
    viewPosition = place.xyz;
    viewNormal = normalToView * gridNormal;
    tintColour = vec4(tint.rgb, tint.a > 0.75 ? 1.0 : 0.0);
    for (int i = 0; i < cutCount; ++i)
        gl_ClipDistance[i] = dot(cuts[i].xyz, gridPosition) + cuts[i].w;
    // All vertices of a hidden piece fall on one point out of view: nothing of it is drawn.
    gl_Position = tint.a > 0.25 ? viewToClip * place : vec4(0.0, 0.0, 2.0, 1.0);
}
