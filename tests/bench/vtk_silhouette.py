# SPDX-License-Identifier: Apache-2.0
"""Milliseconds that vtkPolyDataSilhouette takes for one view of a PLY file: the median over a circle of cameras, three
radii away. Needs VTK's Python module (Debian: python3-vtk9); says so and exits 1 without it."""

import math
import statistics
import sys
import time

try:
    import vtkmodules.all as vtk
except ImportError:
    sys.exit("python3-vtk9 is not installed")


def main(path, views=9):
    reader = vtk.vtkPLYReader()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    low_x, high_x, low_y, high_y, low_z, high_z = mesh.GetBounds()
    center = ((low_x + high_x) / 2, (low_y + high_y) / 2, (low_z + high_z) / 2)
    radius = math.dist((low_x, low_y, low_z), (high_x, high_y, high_z)) / 2
    camera = vtk.vtkCamera()
    silhouette = vtk.vtkPolyDataSilhouette()
    silhouette.SetInputData(mesh)
    silhouette.SetCamera(camera)
    silhouette.SetEnableFeatureAngle(0)
    silhouette.BorderEdgesOff()
    times = []
    for view in range(views + 1):
        angle = 2 * math.pi * view / views
        camera.SetPosition(center[0] + 3 * radius * math.sin(angle), center[1] + radius,
                           center[2] + 3 * radius * math.cos(angle))
        camera.SetFocalPoint(*center)
        silhouette.Modified()
        start = time.process_time()
        silhouette.Update()
        times.append(1e3 * (time.process_time() - start))
        if silhouette.GetOutput().GetNumberOfCells() == 0:
            sys.exit("vtkPolyDataSilhouette found nothing")
    print("%.3f" % statistics.median(times[1:]))  # the first one builds what the others reuse


if __name__ == "__main__":
    main(sys.argv[1])
