#version 330 core
// Vertex codes in, view space out: positions and normals are made here, of the points that the codes refer to, as
// vertexOf() in core/extract/live/edge_record.h makes them.
layout(location = 0) in uint code; // core/extract/live/vertex_code.h
layout(location = 2) in vec4 tint; // linear light; a: 0 hidden, half plain, 1 in this colour; (0, 0, 0, 1) without tints

uniform usamplerBuffer places; // of the brick of each 32 vertices: x and y, z, its first line of points, its first in inner
uniform usamplerBuffer scalars, normals; // of all points; lines of 64 bytes, a brick's 736 scalars before its normals
uniform usamplerBuffer inner; // vertices inside cells: place, normal and level
uniform int scalarBytes; // integers are keys, but for those of 4 bytes, which are bits of floats
uniform int zeroKey; // the key of 0
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

void placeInside(vec3 brick, uint first) {
    uvec4 record = texelFetch(inner, int(first + (code >> 2u)));
    gridPosition = brick + uintBitsToFloat(record.xyz);
    leafLevel = float(record.w >> 16u);
    vec3 direction = directionOf(record.w & 0xffffu);
    float size = sqrt(dot(direction, direction));
    gridNormal = size > 0.0 ? direction / size : direction;
}

float scalarAt(int place) {
    uint key = texelFetch(scalars, place).x;
    return scalarBytes == 4 ? uintBitsToFloat(key) : float(int(key) - zeroKey);
}

void placeOnEdge(vec3 brick, uint line) {
    uint axis = code & 3u;
    uint point = code >> 2u & 1023u;
    uint side = 1u << (code >> 12u);
    uvec3 first = uvec3(point % 9u, point / 9u % 9u, point / 81u);
    first[axis] &= ~(side - 1u); // leaf edges are aligned at multiples of their length
    uvec3 strides = uvec3(1u, 9u, 81u);
    int lower = int(first.x + 9u * first.y + 81u * first.z), upper = lower + int(side * strides[axis]);
    int firstScalar = int(line) * (64 / scalarBytes);
    int firstNormal = int(line) * 32 + 736 / 2 * scalarBytes;
    vec2 ends = vec2(scalarAt(firstScalar + lower), scalarAt(firstScalar + upper));
    vec3 along = vec3(axis == 0u, axis == 1u, axis == 2u);
    // Halves, so that differences of large numbers stay finite; what is not a number becomes 0.
    float t = (isovalue * 0.5 - ends.x * 0.5) / (ends.y * 0.5 - ends.x * 0.5);
    t = t > 0.0 ? t : 0.0;
    t = t < 1.0 ? t : 1.0;
    gridPosition = brick + vec3(first) + along * (t * float(side));
    vec3 normal1 = directionOf(texelFetch(normals, firstNormal + lower).x);
    vec3 normal2 = directionOf(texelFetch(normals, firstNormal + upper).x);
    vec3 sum = normal1 + t * (normal2 - normal1);
    float square = dot(sum, sum);
    gridNormal = square < 1e-12 ? along * (ends.x < ends.y ? -1.0 : 1.0) : sum * (1.0 / sqrt(square));
    leafLevel = float(code >> 12u);
}

void main() {
    uvec4 its = texelFetch(places, gl_VertexID >> 5);
    vec3 brick = 8.0 * vec3(its.x & 0xffffu, its.x >> 16u, its.y);
    if ((code & 3u) == 3u)
        placeInside(brick, its.w);
    else
        placeOnEdge(brick, its.z);
    vec4 place = modelToView * vec4(gridPosition, 1.0);
    viewPosition = place.xyz;
    viewNormal = normalToView * gridNormal;
    tintColour = vec4(tint.rgb, tint.a > 0.75 ? 1.0 : 0.0);
    for (int i = 0; i < cutCount; ++i)
        gl_ClipDistance[i] = dot(cuts[i].xyz, gridPosition) + cuts[i].w;
    // All vertices of a hidden piece fall on one point out of view: nothing of it is drawn.
    gl_Position = tint.a > 0.25 ? viewToClip * place : vec4(0.0, 0.0, 2.0, 1.0);
}
