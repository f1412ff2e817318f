#version 330 core
layout(location = 0) in vec3 position;

uniform mat4 modelToView;
uniform mat4 viewToClip;

void main() { gl_Position = viewToClip * (modelToView * vec4(position, 1.0)); }
