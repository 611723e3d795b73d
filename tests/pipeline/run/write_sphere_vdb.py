"""Writes a level set of a ball and a grid of vectors beside it. usage: write_sphere_vdb.py FILE
RADIUS VOXEL"""

import sys

import pyopenvdb

path, radius, voxel = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
ball = pyopenvdb.createLevelSetSphere(radius=radius, center=(10.0, -4.0, 7.5), voxelSize=voxel)
ball.name = "ball"
wind = pyopenvdb.Vec3SGrid()
wind.name = "wind"
wind.fill((0, 0, 0), (3, 3, 3), (1.0, 2.0, 3.0))
pyopenvdb.write(path, grids=[ball, wind])
