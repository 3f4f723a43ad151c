"""What is read off a pyramid: profiles, contours, differences, shapes of triangles."""
