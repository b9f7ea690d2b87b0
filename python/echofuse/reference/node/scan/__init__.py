"""References of the stages that turn one raw scan into detections."""
