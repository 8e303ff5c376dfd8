#!/bin/sh
# OpenCV 5.0.0 (opencv-contrib-python-headless 5.0.0.93): one way of refining tag corners shifts the tag by half a pixel.
#
# Expected: the four settings of `cornerRefinementMethod` differ in noise. The tag's mean corner is the same in all.
# Happens: NONE and SUBPIX count from the centre of the first pixel, as the camera calibration does. APRILTAG counts from
# the pixel's edge, so each corner lies half a pixel further right and down.
# Met by: anyone who tracks a robot by a tag under a ceiling camera and changes the refinement between calibration and log:
# at 4 mm a pixel all poses move by 2 mm on each axis, and a tag seen by two pipelines has two places.
# Seen: centre of one tag 279.5, 179.5 with NONE and with SUBPIX, 280.0, 180.0 with APRILTAG.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check opencv-contrib-python-headless==5.0.0.93 numpy==2.4.6
cd "$dir"
venv/bin/python - <<'END'
import cv2
import numpy as np

tags = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
image = np.full((480, 640), 255, np.uint8)
image[100:260, 200:360] = cv2.aruco.generateImageMarker(tags, 3, 160)

def middle(method):
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = method
    corners, _, _ = cv2.aruco.ArucoDetector(tags, parameters).detectMarkers(image)
    return [round(float(c), 2) for c in corners[0][0].mean(axis=0)]

methods = {"none": cv2.aruco.CORNER_REFINE_NONE, "subpix": cv2.aruco.CORNER_REFINE_SUBPIX,
           "apriltag": cv2.aruco.CORNER_REFINE_APRILTAG}
seen = {name: middle(method) for name, method in methods.items()}
print(seen)
if seen != {"none": [279.5, 179.5], "subpix": [279.5, 179.5], "apriltag": [280.0, 180.0]}:
    raise SystemExit("the behaviour changed")
END
