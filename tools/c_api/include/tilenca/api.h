/* What the public C headers of all libraries share. */
#ifndef TILENCA_API_H
#define TILENCA_API_H

/* Marks every function that a library exports; all else in it is hidden. WebAssembly's linker drops whatever
 * is not marked as used. */
#ifdef __EMSCRIPTEN__
#define TILENCA_API __attribute__((used, visibility("default")))
#else
#define TILENCA_API __attribute__((visibility("default")))
#endif

#endif
