#version 330 core
// Grid index units in, view space out. The matrices come from doubles and hold the centring.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

layout(location = 2) in vec4 tint; // linear light; a: 0 hidden, half plain, 1 in this colour; (0, 0, 0, 1) without tints
layout(location = 3) in float level; // of the leaf edge it lies on; 0 where arrays have none

uniform mat4 modelToView;
uniform mat4 viewToClip;
uniform mat3 normalToView;
uniform vec4 cuts[7]; // half-spaces that what is drawn lies in: dot(xyz, place) + w >= 0, grid index units
uniform int cutCount;

out vec3 viewPosition;
out vec3 viewNormal;
out vec3 gridPosition;
out float leafLevel;
flat out vec4 tintColour;
out float gl_ClipDistance[7];

void main() {
    vec4 place = modelToView * vec4(position, 1.0);
    viewPosition = place.xyz;
    viewNormal = normalToView * normal;
    gridPosition = position;
    leafLevel = level;
    tintColour = vec4(tint.rgb, tint.a > 0.75 ? 1.0 : 0.0);
    for (int i = 0; i < cutCount; ++i)
        gl_ClipDistance[i] = dot(cuts[i].xyz, gridPosition) + cuts[i].w;
    // All vertices of a hidden piece fall on one point out of view: nothing of it is drawn.
    gl_Position = tint.a > 0.25 ? viewToClip * place : vec4(0.0, 0.0, 2.0, 1.0);
}
