"""Scenes on the disk as Habitat's users have them: HM3D, MP3D and this project's own export."""
