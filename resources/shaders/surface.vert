#version 330 core
// Grid index units in, view space out. The matrices come from doubles and hold the centring.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

uniform mat4 modelToView;
uniform mat4 viewToClip;
uniform mat3 normalToView;

out vec3 viewPosition;
out vec3 viewNormal;
out vec3 gridPosition;
out float leafLevel;

void main() {
    vec4 place = modelToView * vec4(position, 1.0);
    viewPosition = place.xyz;
    viewNormal = normalToView * normal;
    gridPosition = position;
    leafLevel = 0.0;
    gl_Position = viewToClip * place;
}
