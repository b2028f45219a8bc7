"""Houses and meshes: formats, generator, importers, and the scene that a simulator loads.

Start at `loading`: `load_scene` takes what a user types and returns a `Scene`. Houses (`house`,
`house_io`, `validation`) become scenes in `meshing`; mesh files do in `gltf`. Importers
(`domestigraph`, `procthor`) make houses, by way of the `plan_*` modules where all that is known is
boxes. Submodules are imported one by one, since some of them load heavy libraries.
"""

__all__: list[str] = []
