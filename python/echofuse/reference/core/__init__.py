"""What the other rooms lean on."""
